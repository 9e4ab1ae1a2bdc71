#include "bench/haptic/adapter.h"
#include "bench/haptic/bullet_adapter.h"
#include "bench/haptic/palpate_adapter.h"
#include "bench/haptic/vps.h"

namespace yardstick {

std::vector<AdapterMaker> adapters() {
  return {{"palpate", make_palpate}, {"vps", make_vps}, {"bullet", make_bullet}};
}

}  // namespace yardstick
