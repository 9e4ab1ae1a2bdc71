#include "tests/mutation/oracle.h"

#include <algorithm>
#include <numeric>
#include <stdexcept>

#include "model/response.h"
#include "tests/equivalence/contacts_difference.h"
#include "tests/equivalence/touching_poses.h"

namespace palpate::mutation {
namespace {

template <class T>
T must(Result<T> result) {
  if (!result) throw std::runtime_error(result.error().sentence);
  return std::move(*result);
}
void must(const Result<void>& result) {
  if (!result) throw std::runtime_error(result.error().sentence);
}

bool go_on(const char*, double) { return true; }

}  // namespace

Oracle::Oracle(CollisionBackend& backend, bool killers) : backend_(backend) {
  std::vector<equivalence::Case> wanted = equivalence::all_cases();
  std::stable_partition(wanted.begin(), wanted.end(), [](const equivalence::Case& c) { return c.killer; });
  cases_.reserve(wanted.size());   // back ends keep the geometry's address
  // The chapter's large scenes ask nothing that small ones don't, at many times the price.
  for (const equivalence::Case& w : wanted)
    if (killers ? w.killer : w.family != "chapter") answer(w);
  order_.resize(cases_.size());
  std::iota(order_.begin(), order_.end(), std::size_t{0});
}

void Oracle::answer(const equivalence::Case& wanted) {
  constexpr std::uint64_t kSeed = 1;
  Case& c = cases_.emplace_back();
  c.name = wanted.name;
  equivalence::TestScene scene = must(wanted.make(kSeed));
  c.geometry = std::move(scene.geometry);
  c.plan.profile = wanted.profile;
  c.plan.est = wanted.profile == Profile::kRefined;
  must(backend_.prepare(c.geometry, c.plan, go_on));
  c.mockup = must(backend_.partition(false));
  if (wanted.profile == Profile::kRefined) c.tool = must(backend_.partition(true));

  Held held;
  ContactResponse response;
  for (int i = 0; i < wanted.poses; ++i) {
    equivalence::Random random(kSeed, static_cast<std::uint64_t>(i));
    equivalence::Known known;
    Query q;
    if (wanted.held && i % equivalence::kChain != 0)
      q.pose = equivalence::moved_on(c.queries.back().pose, c.geometry.mockup_grid.size, random);
    else
      q.pose = scene.pose(c.geometry, random, known), held = {};
    q.held = held;
    q.remembers = wanted.held;
    must(backend_.query(q.pose, q.remembers ? &q.held : nullptr, q.answer));
    respond(q.answer, q.pose, c.geometry, wanted.profile, 1000, response, q.remembers ? &q.held : nullptr);
    remember(q.answer, response, held);
    c.queries.push_back(std::move(q));
  }
}

std::string Oracle::ask(const Case& c) const {
  if (auto r = backend_.prepare(c.geometry, c.plan, go_on); !r) return "prepare: " + r.error().sentence;
  for (const bool tool : {false, true}) {
    if (tool && c.plan.profile != Profile::kRefined) continue;
    const auto partition = backend_.partition(tool);
    if (!partition) return partition.error().sentence;
    if (const std::string difference = first_difference(*partition, tool ? c.tool : c.mockup); !difference.empty())
      return std::string(tool ? "tool's" : "mock-up's") + " partition: " + difference;
  }
  Contacts answer;
  for (std::size_t i = 0; i < c.queries.size(); ++i) {
    const Query& q = c.queries[i];
    if (auto r = backend_.query(q.pose, q.remembers ? &q.held : nullptr, answer); !r) return r.error().sentence;
    if (const std::string difference = first_difference(answer, q.answer); !difference.empty())
      return "pose " + std::to_string(i) + ": " + difference;
  }
  return {};
}

std::string Oracle::first_difference_now(std::size_t& of) const {
  for (const std::size_t c : order_) {
    of = c;
    if (std::string difference = ask(cases_[c]); !difference.empty()) return difference;
  }
  return {};
}

void Oracle::ask_first(std::size_t c) {
  const auto at = std::find(order_.begin(), order_.end(), c);
  std::rotate(order_.begin(), at, at + 1);
}

}  // namespace palpate::mutation
