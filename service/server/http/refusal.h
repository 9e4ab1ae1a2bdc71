#pragma once
#include <optional>
#include <string_view>
#include <utility>

#include "service/server/http/http_message.h"

namespace palpate {

/// A body that is not wanted: says no at once, and to every piece.
class Refusal final : public BodySink {
 public:
  explicit Refusal(Problem problem) : problem_(std::move(problem)) {}
  std::optional<Problem> write(std::string_view) override { return problem_; }
  void finish(Reply reply) override { reply(problem_); }

 private:
  Problem problem_;
};

}  // namespace palpate
