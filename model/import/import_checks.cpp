#include "model/import/import_checks.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <map>
#include <optional>
#include <vector>

#include "model/files/one_line.h"
#include "model/import/text_numbers.h"

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

constexpr const char* kUtf16 = "is UTF-16 text; save it as UTF-8 or ASCII";

/// By the mark at its beginning, or by the byte of zeros in every character of ASCII.
bool is_utf16(std::string_view bytes) {
  const std::string_view begin = bytes.substr(0, 2);
  return begin == std::string_view("\xFF\xFE", 2) || begin == std::string_view("\xFE\xFF", 2) ||
         begin == std::string_view("<\0", 2) || begin == std::string_view("\0<", 2);
}

/// Facets of STL text with more than three vertices, of which the library would take three, and their
/// numbers.
std::string distrust_stl_facets(std::string_view text) {
  std::size_t vertices = 0, number = 0;
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    std::string_view line = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    ++number;
    const std::string_view word = take_word(line);
    if (word == "endloop") vertices = 0;
    if (word != "vertex") continue;
    if (++vertices > 3) return fmt::format("has a facet of more than three vertices, in line {}", number);
    if (std::string wrong = distrust_numbers(line, 3, "line", number); !wrong.empty()) return wrong;
  }
  return {};
}

constexpr std::size_t kStlHeader = 84, kStlFacet = 50;  // bytes

std::uint32_t binary_stl_facets(std::string_view bytes) {
  std::uint32_t facets = 0;
  if (bytes.size() >= kStlHeader) std::memcpy(&facets, bytes.data() + 80, 4);
  return facets;
}

/// As large as the binary STL that its header promises.
bool is_binary_stl(std::string_view bytes) {
  return bytes.size() >= kStlHeader &&
         bytes.size() == kStlHeader + kStlFacet * std::uint64_t{binary_stl_facets(bytes)};
}

bool begins_as_text(std::string_view bytes, std::string_view word) {
  const std::string_view start = trimmed(bytes.substr(0, 512));
  return start.starts_with(word) && start.find('\0') == std::string_view::npos;
}

}  // namespace

bool is_stl_text(std::string_view bytes) { return !is_binary_stl(bytes) && begins_as_text(bytes, "solid"); }

std::string distrust_stl(std::string_view bytes) {
  if (is_binary_stl(bytes)) return {};
  if (is_stl_text(bytes)) {
    const std::string_view end = trimmed(bytes);
    const std::size_t last = end.find_last_of('\n');
    if (trimmed(end.substr(last == std::string_view::npos ? 0 : last)).substr(0, 8) != "endsolid")
      return "does not end with 'endsolid': it is cut short, or something follows";
    return distrust_stl_facets(bytes);
  }
  if (begins_as_text(bytes, "SOLID")) return "is STL text in capitals; its words must be in small letters";
  if (bytes.size() < kStlHeader)
    return fmt::format("is cut short: a binary STL has at least {} bytes, it has {}", kStlHeader,
                       bytes.size());
  const std::uint64_t facets = binary_stl_facets(bytes), wanted = kStlHeader + kStlFacet * facets;
  return fmt::format("{}: its {} facets take {} bytes, it has {}",
                     bytes.size() < wanted ? "is cut short" : "is not an STL file", facets, wanted,
                     bytes.size());
}

std::string distrust_off(std::string_view bytes) {
  const std::size_t size = bytes.size();
  std::string_view line = next_line(bytes);
  if (const std::size_t name = line.find("OFF");
      name != std::string_view::npos) {  // "OFF", "COFF", …, counts may follow
    line = trimmed(line.substr(name + 3));
    if (line == "BINARY") return "is a binary OFF file, which can't be read";
    if (line.empty()) line = next_line(bytes);
  }
  std::uint64_t vertices = 0, faces = 0;
  if (!take_number(line, vertices) || !take_number(line, faces))
    return "has no vertex and face counts in its header";
  // A vertex takes at least "0 0 0\n", a face "1 0\n".
  if (vertices > size / 6 || faces > size / 4)
    return fmt::format("promises {} vertices and {} faces, more than its {} bytes can hold", vertices, faces,
                       size);
  for (std::uint64_t v = 0; v < vertices; ++v) {
    line = next_line(bytes);
    if (line.empty()) return fmt::format("is cut short: it promises {} vertices and has {}", vertices, v);
    if (std::string wrong = distrust_numbers(line, 3, "vertex", v); !wrong.empty()) return wrong;
  }
  for (std::uint64_t f = 0; f < faces; ++f) {
    line = next_line(bytes);
    if (line.empty()) return fmt::format("is cut short: it promises {} faces and has {}", faces, f);
    std::uint64_t corners = 0, index = 0;
    if (!take_number(line, corners)) return fmt::format("has no corner count in face {}", f);
    constexpr std::uint64_t kMostCorners =
        9;  // the library leaves larger ones out, and empty ones, and then counts the others wrong
    if (corners == 0)
      return fmt::format("has 0 corners in face {}; OFF files with such faces can't be read", f);
    if (corners > kMostCorners)
      return fmt::format("has {} corners in face {}; OFF faces of more than {} can't be read", corners, f,
                         kMostCorners);
    for (std::uint64_t k = 0; k < corners; ++k) {
      if (!take_number(line, index))
        return fmt::format("is cut short in face {}: {} of {} corners", f, k, corners);
      if (index >= vertices)
        return fmt::format("has vertex index {} in face {}, beyond the vertex list (size {})", index, f,
                           vertices);
    }
  }
  return {};
}

namespace {

/// How many vertices, places on a texture and normals an OBJ has.
using ObjCounts = std::array<std::uint64_t, 3>;

/// Faces of an OBJ: indices from 1 on, or from −1 back. Normals and places on a texture are of no use, but
/// the library drops a face whose are beyond their lists.
std::string distrust_obj_face(std::string_view line, const ObjCounts& before, const ObjCounts& all,
                              std::size_t number) {
  constexpr std::array<const char*, 3> kNames = {"vertex", "texture", "normal"};
  while (!line.empty()) {
    const std::size_t end = std::min(line.find_first_of(" \t"), line.size());
    const std::string_view word = line.substr(0, end);
    line = trimmed(line.substr(end));
    std::string_view rest = word;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t slash = rest.find('/');
      const std::string_view index = rest.substr(0, slash);
      rest = slash == std::string_view::npos ? std::string_view() : rest.substr(slash + 1);
      if (k > 0 && index.empty()) continue;
      std::int64_t value = 0;
      const auto [after, error] = std::from_chars(index.data(), index.data() + index.size(), value);
      if (error != std::errc() || after != index.data() + index.size())
        return fmt::format("has '{}' for a vertex in line {}", word.substr(0, 40), number);
      if (value == 0) return fmt::format("has {} index 0 in line {}; they begin with 1", kNames[k], number);
      if (value > 0 ? static_cast<std::uint64_t>(value) > all[k]
                    : static_cast<std::uint64_t>(-value) > before[k])
        return fmt::format("has {} index {} in line {}, beyond the {} list (size {})", kNames[k], value,
                           number, kNames[k], value > 0 ? all[k] : before[k]);
    }
  }
  return {};
}

/// Vertices of an OBJ, places on a texture and normals. The library leaves out a vertex of another number of
/// numbers than these, and then takes the next one for it.
std::string distrust_obj_numbers(std::string_view line, std::size_t list, std::size_t number) {
  line = line.substr(0, line.find('#'));
  take_word(line);
  std::size_t count = 0;
  for (std::string_view rest = line; !take_word(rest).empty();) ++count;
  if (list == 0 && count != 3 && count != 4 && count != 6)
    return fmt::format("has a vertex of {} numbers in line {}; of 3, 4 or 6 it can be read", count, number);
  return distrust_numbers(line, count, "line", number);
}

/// Which of an OBJ's lists a line is of.
std::optional<std::size_t> obj_list(std::string_view line) {
  if (line.size() < 3 || line[0] != 'v') return std::nullopt;
  if (blank(line[1])) return 0;
  if (!blank(line[2])) return std::nullopt;
  return line[1] == 't'   ? std::optional<std::size_t>(1)
         : line[1] == 'n' ? std::optional<std::size_t>(2)
                          : std::nullopt;
}

}  // namespace

std::string distrust_obj(std::string_view bytes) {
  if (is_utf16(bytes)) return kUtf16;
  std::string joined;  // where lines go on in the next: a backslash and a line's end are a blank
  if (bytes.find("\\\n") != std::string_view::npos || bytes.find("\\\r\n") != std::string_view::npos) {
    joined = bytes;
    // Where the line begins that a backslash is in, as far as it is joined, and up to where that is known.
    std::size_t begin = 0, seen = 0;
    for (std::size_t at = joined.find('\\'); at != std::string::npos; at = joined.find('\\', at + 1)) {
      const std::size_t end = joined.compare(at + 1, 2, "\r\n") == 0 ? at + 2 : at + 1;
      if (end >= joined.size() || joined[end] != '\n') continue;
      const std::size_t before = std::string_view(joined).substr(seen, at - seen).rfind('\n');
      if (before != std::string_view::npos) begin = seen + before + 1;
      seen = end + 1;
      if (joined.compare(begin, 2, "o ") == 0 || joined.compare(begin, 2, "g ") == 0)
        return fmt::format(
            "has a name in line {} that ends in a backslash, with which the next line belongs to it",
            1 + std::count(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(at), '\n'));
      std::fill(joined.begin() + static_cast<std::ptrdiff_t>(at),
                joined.begin() + static_cast<std::ptrdiff_t>(end) + 1, ' ');
    }
    bytes = joined;
  }
  // Twice: vertices may stand behind the faces that name them.
  ObjCounts all{};
  std::map<std::string_view, std::size_t> named;  // by `o` or `g`, and the line where each begins
  std::string_view name;                          // that was given last
  for (const bool count : {true, false}) {
    ObjCounts before{};
    std::size_t number = 0;
    for (std::string_view text = bytes; !text.empty();) {
      const std::size_t end = text.find('\n');
      std::string_view line = trimmed(text.substr(0, end));
      text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
      ++number;
      if (const auto list = obj_list(line)) {
        ++(count ? all : before)[*list];
        if (count)
          if (std::string wrong = distrust_obj_numbers(line, *list, number); !wrong.empty()) return wrong;
      }
      if (count && line == "o" && !named.empty())
        return fmt::format(
            "has an object without a name in line {}; give it one, or its triangles join another", number);
      if (count && line == "g") name = {};  // a group without a name is another one
      if (line.size() < 2 || !blank(line[1])) continue;
      if (line[0] == 'V' || line[0] == 'F')
        return fmt::format("has '{}' in line {}; OBJ's words are in small letters", line[0], number);
      if (count && (line[0] == 'o' || line[0] == 'g') && trimmed(line.substr(1)) != name) {
        name = trimmed(line.substr(1));
        // The library goes on with an object of that name, but not with its triangles.
        if (const auto [at, first] = named.emplace(name, number); !first && line[0] == 'o') {
          std::string shown(name.substr(0, 60));
          std::replace(shown.begin(), shown.end(), kBlankOfName, ' ');
          return fmt::format(
              "has an object '{}' in line {} and another one in line {}; give each a name of "
              "its own, or their triangles get mixed up",
              one_line(shown), at->second, number);
        }
      }
      if (count || line[0] != 'f') continue;
      line = trimmed(line.substr(
          1, line.find('#') == std::string_view::npos ? std::string_view::npos : line.find('#') - 1));
      if (std::string wrong = distrust_obj_face(line, before, all, number); !wrong.empty()) return wrong;
    }
  }
  return {};
}

namespace {

/// The value of a tag's attribute, "" if it has none. Blanks may stand around its =.
std::string_view attribute_of(std::string_view tag, std::string_view name) {
  for (std::size_t at = tag.find(name); at != std::string_view::npos; at = tag.find(name, at + 1)) {
    if (at == 0 || !blank(tag[at - 1])) continue;
    const std::string_view rest = trimmed(tag.substr(at + name.size()));
    if (!rest.starts_with('=')) continue;
    const std::string_view value = trimmed(rest.substr(1));
    if (value.empty() || (value[0] != '"' && value[0] != '\'')) return {};
    return value.substr(1, value.find(value[0], 1) - 1);
  }
  return {};
}

/// Whether a count is written as digits alone; the library would read others, "0x10" among them.
bool is_count(std::string_view text) {
  return std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
}

/// Every accessor of a COLLADA file against the numbers that the library takes from its array: as many as the
/// array has, and as it says that it has. Where an accessor goes further the library reads what lies behind
/// them.
std::string distrust_dae_arrays(std::string_view bytes) {
  std::map<std::string_view, std::uint64_t> holds;  // by id
  const auto value = [](std::string_view digits, std::uint64_t otherwise) {
    std::uint64_t out = 0;
    return take_number(digits, out) ? out : otherwise;
  };
  for (const bool arrays : {true, false})
    for (std::size_t at = bytes.find('<'); at != std::string_view::npos; at = bytes.find('<', at + 1)) {
      const std::string_view rest = bytes.substr(at), tag = rest.substr(0, rest.find('>'));
      const bool array = rest.starts_with("<float_array"), accessor = rest.starts_with("<accessor");
      if (!array && !accessor) continue;
      const bool empty = tag.ends_with('/');
      const std::string_view content = rest.substr(std::min(rest.size(), tag.size() + 1)),
                             count = attribute_of(tag, "count");
      for (const std::string_view number : {count, attribute_of(tag, "stride"), attribute_of(tag, "offset")})
        if (!is_count(number))
          return fmt::format("has '{}' for a count, stride or offset", number.substr(0, 40));
      if (arrays && array) {
        std::uint64_t numbers = 0;
        if (!empty) {
          bool in_word = false;
          for (const char c : content.substr(0, content.find('<'))) {
            if (!blank(c) && !in_word) ++numbers;
            in_word = !blank(c);
          }
        }
        holds[attribute_of(tag, "id")] = std::min(numbers, value(count, 0));
      }
      if (!arrays && accessor) {
        const std::string_view source = attribute_of(tag, "source");
        const auto of = source.empty() ? holds.end() : holds.find(source.substr(1));
        const std::uint64_t times = value(count, 0);
        if (of == holds.end() || times == 0) continue;
        std::uint64_t names = 0;  // each is the place of a number, from where an item begins
        const std::string_view body =
            empty ? std::string_view() : content.substr(0, content.find("</accessor"));
        for (std::size_t name = body.find("<param"); name != std::string_view::npos;
             name = body.find("<param", name + 1))
          ++names;
        const std::uint64_t stride = value(attribute_of(tag, "stride"), 1),
                            offset = value(attribute_of(tag, "offset"), 0), item = std::max(stride, names);
        if (offset > of->second || item > of->second - offset ||
            (stride != 0 && times - 1 > (of->second - offset - item) / stride))
          return fmt::format(
              "has an accessor of {} times {} numbers, {} apart, from number {} on, beyond its array '{}' of "
              "{}",
              times, item, stride, offset, of->first.substr(0, 40), of->second);
      }
    }
  return {};
}

}  // namespace

std::string distrust_dae(std::string_view bytes) {
  if (is_utf16(bytes)) return kUtf16;
  if (std::string wrong = distrust_dae_arrays(bytes); !wrong.empty()) return wrong;
  // Which nodes hold which: by nesting, and by <instance_node url="#id"/>. Reads tags alone, and what index
  // lists hold.
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
      return rest.substr(0, start.size()) == start && rest.size() > start.size() &&
             (blank(rest[start.size()]) || rest[start.size()] == '>');
    };
    const std::string_view tag = rest.substr(0, rest.find('>'));
    if (const std::string count = attribute(tag, " count="); !count.empty()) {
      std::string_view digits = count;
      std::uint64_t value = 0;
      if (!take_number(digits, value) || value > bytes.size())
        return fmt::format("has a count of '{}', more than its {} bytes can hold", count.substr(0, 40),
                           bytes.size());
    }
    if (is("<p") || is("<vcount") || is("<v") ||
        is("<h")) {  // on anything but digits the importer would turn for ever
      const std::string_view content = rest.substr(tag.size(), rest.find('<', tag.size()) - tag.size());
      const std::size_t odd = content.find_first_not_of("0123456789 \t\r\n-", 1);
      if (odd < content.size())
        return std::isprint(static_cast<unsigned char>(content[odd]))
                   ? fmt::format("has '{}' among its vertex indices", content[odd])
                   : fmt::format("has a byte {:#x} among its vertex indices",
                                 static_cast<unsigned char>(content[odd]));
      if (is("<p") && content.find('-') < content.size()) return "has '-' among its vertex indices";
    }
    for (const std::string_view of : {"float_array", "matrix", "translate", "rotate", "scale"}) {
      if (tag.size() <= of.size() || tag.substr(1, of.size()) != of || !is(rest.substr(0, of.size() + 1)))
        continue;
      std::string_view content = rest.substr(tag.size(), rest.find('<', tag.size()) - tag.size());
      if (content.starts_with('>')) content.remove_prefix(1);
      for (std::string_view word = take_word(content); !word.empty(); word = take_word(content))
        if (!is_decimal(word))
          return fmt::format("has '{}' for a number of a <{}>", one_line(std::string(word.substr(0, 40))),
                             of);
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
  std::map<std::string, int, std::less<>> state;  // 1: open, 2: done
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
      if (state[child] == 1)
        return fmt::format("has a node that contains itself ('{}')", std::string_view(child).substr(0, 40));
      if (state[child] == 0) state[child] = 1, stack.emplace_back(child, 0);
    }
  }
  return {};
}

}  // namespace palpate
