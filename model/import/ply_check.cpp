#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "model/files/one_line.h"
#include "model/import/import_checks.h"
#include "model/import/text_numbers.h"

namespace palpate {
namespace {

struct Property {
  std::size_t size = 0;        ///< bytes of the value, or of a list's entry
  std::size_t count_size = 0;  ///< bytes of a list's count; 0: no list
};
struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};
struct Header {
  std::string format;
  std::vector<Element> elements;
  std::size_t length = 0;  ///< bytes, with end_header and its line end
};

std::size_t size_of_type(const std::string& type) {
  if (type == "char" || type == "uchar" || type == "int8" || type == "uint8") return 1;
  if (type == "short" || type == "ushort" || type == "int16" || type == "uint16") return 2;
  if (type == "int" || type == "uint" || type == "float" || type == "int32" || type == "uint32" ||
      type == "float32")
    return 4;
  if (type == "double" || type == "float64") return 8;
  return 0;
}

constexpr const char* kNoHeader = "has no valid PLY header";

/// Reads the header; what is wrong with it, "" when nothing is. What the importer would pass over or read in
/// another way is wrong: it writes beyond the room of a first element's vertices when a second one of that
/// name has more.
std::string read_header(std::string_view bytes, Header& header) {
  std::set<std::string> names;
  std::size_t at = 0;
  for (int line_number = 0; line_number < 100000; ++line_number) {
    const std::size_t end = bytes.find('\n', at);
    if (end == std::string_view::npos) return kNoHeader;
    std::istringstream line{std::string(bytes.substr(at, std::min<std::size_t>(end - at, 1000)))};
    at = end + 1;
    std::string word, type;
    line >> word;
    if (line_number == 0) {
      if (word != "ply") return kNoHeader;
    } else if (word == "format") {
      line >> header.format;
    } else if (word == "element") {
      Element element;
      if (!(line >> element.name >> element.count)) return kNoHeader;
      if (element.name == "tristrips")
        return "keeps its triangles in strips (element 'tristrips'), which can't be read; save it with faces";
      if (!names.insert(element.name).second)
        return fmt::format("has two elements '{}'", element.name.substr(0, 40));
      header.elements.push_back(element);
    } else if (word == "property") {
      Property property;
      if (header.elements.empty() || !(line >> type)) return kNoHeader;
      if (type == "list") {
        std::string count_type;
        line >> count_type >> type;
        property.count_size = size_of_type(count_type);
        if (property.count_size == 0) return kNoHeader;
      }
      property.size = size_of_type(type);
      if (property.size == 0) return kNoHeader;
      header.elements.back().properties.push_back(property);
    } else if (word == "end_header") {
      header.length = at;
      return {};
    } else if (!word.empty() && word != "comment" && word != "obj_info" &&
               word != "Created") {  // "Created by Blender3D 247", without "comment"
      return fmt::format("has a header line that begins with '{}', which PLY does not know",
                         word.substr(0, 40));
    }
  }
  return kNoHeader;
}

/// Of an element with a name that the library does not know it gets the number wrong, and with it the place
/// of all that follows.
std::string distrust_order(const Header& header) {
  static const std::set<std::string, std::less<>> known = {"vertex", "face", "edge", "material"};
  for (std::size_t i = 0; i + 1 < header.elements.size(); ++i) {
    const Element& element = header.elements[i];
    if (element.count != 0 && known.count(element.name) == 0)
      return fmt::format(
          "has {} elements '{}' in front of others, which can't be passed over; save it with vertices and "
          "faces alone",
          element.count, element.name.substr(0, 40));
  }
  return {};
}

std::string cut_short(const Element& element, std::uint64_t have) {
  return fmt::format("is cut short: it promises {} elements '{}' and has {}", element.count,
                     element.name.substr(0, 40), have);
}

std::uint64_t read_count(const char* data, std::size_t size, bool big_endian) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < size; ++i) {
    const auto byte = static_cast<std::uint64_t>(static_cast<unsigned char>(data[i]));
    value |= byte << (8 * (big_endian ? size - 1 - i : i));
  }
  return value;
}

std::string distrust_binary(std::string_view body, const Header& header) {
  const bool big_endian = header.format == "binary_big_endian";
  std::uint64_t at = 0;
  for (const Element& element : header.elements) {
    std::uint64_t fixed = 0;
    bool lists = false;
    for (const Property& property : element.properties) {
      fixed += property.count_size == 0 ? property.size : property.count_size;
      lists |= property.count_size != 0;
    }
    if (fixed == 0) {  // costs no bytes, so a sane count is what bounds the importer's loop
      if (element.count > body.size()) return cut_short(element, 0);
      continue;
    }
    if (element.count > (body.size() - at) / fixed) return cut_short(element, (body.size() - at) / fixed);
    if (!lists) {
      at += element.count * fixed;
      continue;
    }
    for (std::uint64_t i = 0; i < element.count; ++i)
      for (const Property& property : element.properties) {
        const std::uint64_t head = property.count_size == 0 ? property.size : property.count_size;
        if (head > body.size() - at) return cut_short(element, i);
        const std::uint64_t entries =
            property.count_size == 0 ? 0 : read_count(body.data() + at, property.count_size, big_endian);
        at += head;
        if (entries > (body.size() - at) / property.size) return cut_short(element, i);
        at += entries * property.size;
      }
  }
  return {};
}

/// An element's values, which the library looks for in one line. It takes the beginnings of words for
/// numbers.
std::string distrust_values(const Element& element, std::string_view line, std::size_t number) {
  std::size_t plain = 0;  // numbers that stand before the next list
  const auto take = [&](std::size_t count) { return distrust_numbers(line, count, "line", number); };
  for (const Property& property : element.properties) {
    if (property.count_size == 0) {
      ++plain;
      continue;
    }
    if (std::string wrong = take(std::exchange(plain, 0)); !wrong.empty()) return wrong;
    const std::string_view word = take_word(line);
    if (word.empty()) return fmt::format("has no list in line {}, where its header promises one", number);
    std::uint64_t entries = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), entries);
    if (error != std::errc() || end != word.data() + word.size())
      return fmt::format("has '{}' for the length of a list in line {}",
                         one_line(std::string(word.substr(0, 40))), number);
    if (std::string wrong = take(entries); !wrong.empty()) return wrong;
  }
  return take(plain);
}

/// `number`: of the body's first line.
std::string distrust_ascii(std::string_view body, const Header& header, std::size_t number) {
  for (const Element& element : header.elements) {
    if (element.count > body.size()) return cut_short(element, 0);
    for (std::uint64_t i = 0; i < element.count; ++number) {
      if (body.empty()) return cut_short(element, i);
      const std::size_t end = body.find('\n');
      const std::string_view line = body.substr(0, end);
      body.remove_prefix(end == std::string_view::npos ? body.size() : end + 1);
      if (line.find_first_not_of(" \t\r") == std::string_view::npos) continue;
      if (std::string wrong = distrust_values(element, line, number); !wrong.empty()) return wrong;
      ++i;
    }
  }
  return {};
}

}  // namespace

std::string distrust_ply(std::string_view bytes) {
  Header header;
  if (std::string wrong = read_header(bytes, header); !wrong.empty()) return wrong;
  if (std::string wrong = distrust_order(header); !wrong.empty()) return wrong;
  const std::string_view body = bytes.substr(header.length);
  if (header.format == "ascii") {
    const std::string_view head = bytes.substr(0, header.length);
    return distrust_ascii(body, header,
                          static_cast<std::size_t>(std::count(head.begin(), head.end(), '\n')) + 1);
  }
  if (header.format == "binary_little_endian" || header.format == "binary_big_endian")
    return distrust_binary(body, header);
  return fmt::format("has PLY format '{}', which is unknown", header.format.substr(0, 40));
}

}  // namespace palpate
