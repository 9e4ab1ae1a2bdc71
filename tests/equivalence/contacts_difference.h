#pragma once
#include <string>

#include "model/contacts.h"

namespace palpate {

/// The first field in which two answers differ, with both values: "areas[2].rays: 17, 18". Empty when all but times are equal.
std::string first_difference(const Contacts& a, const Contacts& b);

}  // namespace palpate
