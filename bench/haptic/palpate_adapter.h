#pragma once
#include "bench/haptic/adapter.h"

namespace yardstick {

std::unique_ptr<Adapter> make_palpate();

}  // namespace yardstick
