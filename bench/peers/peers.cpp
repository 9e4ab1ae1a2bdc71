#include "service/bench/time/peer.h"

#include "bench/peers/make.h"

namespace palpate {

std::vector<std::unique_ptr<Peer>> make_peers() {
  std::vector<std::unique_ptr<Peer>> out;
  out.push_back(peers::make_fcl());
  out.push_back(peers::make_embree());
  out.push_back(peers::make_bullet());
  out.push_back(peers::make_cgal());
  return out;
}

}  // namespace palpate
