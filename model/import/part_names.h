#pragma once
#include <string>
#include <unordered_map>

namespace palpate {

/// A name of a file as a name in a path: without the slash that joins paths, and without characters that
/// would break a line.
std::string clean_name(std::string name);

/// Tells the children of one node apart: a name that a sibling has already gets a number, "bolt", "bolt#2",
/// "bolt#3".
class SiblingNames {
 public:
  std::string unique(const std::string& name);

 private:
  std::unordered_map<std::string, int> used_;
};

}  // namespace palpate
