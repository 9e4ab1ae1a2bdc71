#pragma once
#include <string>

namespace palpate {

/// The text as HTML and SVG show it, in elements and in quoted attributes: < > & " are named.
std::string markup_text(const std::string& text);

}  // namespace palpate
