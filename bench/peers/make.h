#pragma once
#include <memory>

#include "service/bench/time/peer.h"

namespace palpate::peers {

std::unique_ptr<Peer> make_fcl();
std::unique_ptr<Peer> make_bullet();
std::unique_ptr<Peer> make_cgal();
std::unique_ptr<Peer> make_embree();
std::unique_ptr<QuestionPeer> make_fcl_obbrss();
std::unique_ptr<QuestionPeer> make_fcl_rss();

}  // namespace palpate::peers
