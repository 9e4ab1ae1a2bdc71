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

std::vector<std::unique_ptr<QuestionPeer>> make_question_peers() {
  std::vector<std::unique_ptr<QuestionPeer>> out;
  out.push_back(peers::make_fcl_obbrss());
  out.push_back(peers::make_fcl_rss());
  return out;
}

}  // namespace palpate
