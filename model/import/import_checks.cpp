#include "model/import/import_checks.h"

#include <fmt/format.h>

#include <cctype>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <map>
#include <vector>

namespace palpate {
namespace {

bool blank(char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; }

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  return text;
}

/// Takes the next line that says something, comments (#) and blanks left out; empty at the end.
std::string_view next_line(std::string_view& text) {
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    const std::string_view whole = text.substr(0, end), line = trimmed(whole.substr(0, whole.find('#')));
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    if (!line.empty()) return line;
  }
  return {};
}

/// Takes a whole number off the line; false if there is none, or one beyond 64 bits.
bool take_number(std::string_view& line, std::uint64_t& value) {
  line = trimmed(line);
  const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), value);
  if (error != std::errc()) return false;
  line.remove_prefix(static_cast<std::size_t>(end - line.data()));
  return true;
}

}  // namespace

std::string distrust_stl(std::string_view bytes) {
  constexpr std::size_t kHeader = 84, kFacet = 50;
  const std::string_view start = trimmed(bytes.substr(0, 512));
  std::uint32_t facets = 0;
  if (bytes.size() >= kHeader) std::memcpy(&facets, bytes.data() + 80, 4);
  const std::uint64_t binary_size = kHeader + kFacet * std::uint64_t{facets};
  if (bytes.size() >= kHeader && bytes.size() == binary_size) return {};
  if (start.substr(0, 5) == "solid" && start.find('\0') == std::string_view::npos) {
    const std::string_view end = trimmed(bytes);
    const std::size_t last = end.find_last_of('\n');
    if (trimmed(end.substr(last == std::string_view::npos ? 0 : last)).substr(0, 8) == "endsolid") return {};
    return "is cut short: it does not end with 'endsolid'";
  }
  if (bytes.size() < kHeader) return fmt::format("is cut short: a binary STL has at least {} bytes, it has {}", kHeader, bytes.size());
  return fmt::format("{}: its {} facets take {} bytes, it has {}", bytes.size() < binary_size ? "is cut short" : "is not an STL file",
                     facets, binary_size, bytes.size());
}

std::string distrust_off(std::string_view bytes) {
  const std::size_t size = bytes.size();
  std::string_view line = next_line(bytes);
  if (const std::size_t name = line.find("OFF"); name != std::string_view::npos) {   // "OFF", "COFF", …, counts may follow
    line = trimmed(line.substr(name + 3));
    if (line == "BINARY") return "is a binary OFF file, which can't be read";
    if (line.empty()) line = next_line(bytes);
  }
  std::uint64_t vertices = 0, faces = 0;
  if (!take_number(line, vertices) || !take_number(line, faces)) return "has no vertex and face counts in its header";
  // A vertex takes at least "0 0 0\n", a face "1 0\n".
  if (vertices > size / 6 || faces > size / 4)
    return fmt::format("promises {} vertices and {} faces, more than its {} bytes can hold", vertices, faces, size);
  for (std::uint64_t v = 0; v < vertices; ++v)
    if (next_line(bytes).empty()) return fmt::format("is cut short: it promises {} vertices and has {}", vertices, v);
  for (std::uint64_t f = 0; f < faces; ++f) {
    line = next_line(bytes);
    if (line.empty()) return fmt::format("is cut short: it promises {} faces and has {}", faces, f);
    std::uint64_t corners = 0, index = 0;
    if (!take_number(line, corners)) return fmt::format("has no corner count in face {}", f);
    for (std::uint64_t k = 0; k < corners; ++k) {
      if (!take_number(line, index)) return fmt::format("is cut short in face {}: {} of {} corners", f, k, corners);
      if (index >= vertices) return fmt::format("has vertex index {} in face {}, beyond the vertex list (size {})", index, f, vertices);
    }
  }
  return {};
}

std::string distrust_dae(std::string_view bytes) {
  // Which nodes hold which: by nesting, and by <instance_node url="#id"/>. Reads tags alone, and what index lists hold.
  std::map<std::string, std::vector<std::string>, std::less<>> holds;
  std::vector<std::string> open;
  const auto attribute = [](std::string_view tag, std::string_view name) -> std::string {
    std::size_t at = tag.find(name);
    if (at == std::string_view::npos) return {};
    at += name.size();
    const char quote = at < tag.size() ? tag[at] : '\0';
    if (quote != '"' && quote != '\'') return {};
    return std::string(tag.substr(at + 1, tag.find(quote, at + 1) - at - 1));
  };
  std::size_t unnamed = 0;
  for (std::size_t at = bytes.find('<'); at != std::string_view::npos; at = bytes.find('<', at + 1)) {
    const std::string_view rest = bytes.substr(at);
    const auto is = [&](std::string_view start) {
      return rest.substr(0, start.size()) == start && rest.size() > start.size() && (blank(rest[start.size()]) || rest[start.size()] == '>');
    };
    const std::string_view tag = rest.substr(0, rest.find('>'));
    if (const std::string count = attribute(tag, " count="); !count.empty()) {
      std::string_view digits = count;
      std::uint64_t value = 0;
      if (!take_number(digits, value) || value > bytes.size())
        return fmt::format("has a count of '{}', more than its {} bytes can hold", count.substr(0, 40), bytes.size());
    }
    if (is("<p") || is("<vcount") || is("<v") || is("<h")) {   // on anything but digits the importer would turn for ever
      const std::string_view content = rest.substr(tag.size(), rest.find('<', tag.size()) - tag.size());
      const std::size_t odd = content.find_first_not_of("0123456789 \t\r\n-", 1);
      if (odd < content.size())
        return std::isprint(static_cast<unsigned char>(content[odd]))
                   ? fmt::format("has '{}' among its vertex indices", content[odd])
                   : fmt::format("has a byte {:#x} among its vertex indices", static_cast<unsigned char>(content[odd]));
      if (is("<p") && content.find('-') < content.size()) return "has '-' among its vertex indices";
    }
    if (is("<node")) {
      std::string id = attribute(tag, " id=");
      if (id.empty()) id = fmt::format(" {}", unnamed++);
      if (!open.empty()) holds[open.back()].push_back(id);
      if (tag.back() != '/') open.push_back(std::move(id));
      if (open.size() > 512) return "nests nodes more than 512 deep";
    } else if (is("</node") && !open.empty()) {
      open.pop_back();
    } else if (is("<instance_node") && !open.empty()) {
      const std::string url = attribute(tag, " url=");
      if (url.size() > 1 && url[0] == '#') holds[open.back()].push_back(url.substr(1));
    }
  }
  // Depth first with an explicit stack: a node met again while it is open contains itself.
  std::map<std::string, int, std::less<>> state;   // 1: open, 2: done
  for (const auto& [root, unused] : holds) {
    std::vector<std::pair<std::string, std::size_t>> stack;
    if (state[root] == 0) stack.emplace_back(root, 0), state[root] = 1;
    while (!stack.empty()) {
      auto& [node, next] = stack.back();
      const auto children = holds.find(node);
      if (children == holds.end() || next == children->second.size()) {
        state[node] = 2;
        stack.pop_back();
        continue;
      }
      const std::string child = children->second[next++];
      if (state[child] == 1) return fmt::format("has a node that contains itself ('{}')", std::string_view(child).substr(0, 40));
      if (state[child] == 0) state[child] = 1, stack.emplace_back(child, 0);
    }
  }
  return {};
}

}  // namespace palpate
