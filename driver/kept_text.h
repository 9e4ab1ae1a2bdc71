#pragma once
#include <string>

namespace palpate {

/// The text for as long as the program runs, for a device's guidance(): it may be read when the device is
/// gone. Equal texts are kept once; the sentences of a driver are few. Locks and allocates: for a device's
/// own thread, never for the control loop's.
const char* kept_text(const std::string& text);

}  // namespace palpate
