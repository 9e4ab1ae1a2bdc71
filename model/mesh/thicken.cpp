#include "model/mesh/thicken.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <tuple>
#include <utility>
#include <vector>

#include "model/mesh/components.h"

namespace palpate {
namespace {

constexpr std::uint32_t kBorder = UINT32_MAX;
constexpr double kLeastCosine = 0.5;     // of a mitre: twice half the thickness
constexpr std::size_t kMostAsked = 256;  // triangles of a piece, for how far it encloses (chosen)

using Cell = std::array<std::int64_t, 3>;

/// Corner k of triangle t is number 3 t + k; so is the side from there to the next corner.
std::uint32_t next_corner(std::uint32_t corner) { return corner % 3 == 2 ? corner - 2 : corner + 1; }

class Sheets {
 public:
  Sheets(const Mesh& mesh, double cell, Enclosure* enclosure) : mesh_(mesh) {
    find_places(cell);
    find_triangles();
    find_partners();
    turn_alike();
    find_open(enclosure);
  }

  std::size_t spared() const { return spared_; }
  std::size_t copies() const {
    return static_cast<std::size_t>(std::count(state_.begin(), state_.end(), State::kTwin));
  }
  bool is_copy(std::uint32_t t) const { return state_[t] == State::kTwin; }
  bool is_open(std::uint32_t t) const { return state_[t] == State::kWall; }
  /// The corners of an open triangle, turned as all of its piece.
  std::array<std::uint32_t, 3> corners(std::uint32_t t) const {
    return turned_[t] ? std::array{3 * t, 3 * t + 2, 3 * t + 1} : std::array{3 * t, 3 * t + 1, 3 * t + 2};
  }
  bool is_border(std::uint32_t side) const { return partner_[side] == kBorder; }
  /// By corner: a number that corners of open pieces share which meet in one place, round which their
  /// triangles hang together.
  std::vector<std::uint32_t> joined_corners() {
    Components corners(places_.size());
    for (std::uint32_t side = 0; side < partner_.size(); ++side) {
      const std::uint32_t other = partner_[side];
      if (other == kBorder || other < side) continue;
      const bool along = places_[side] == places_[other];
      corners.join(side, along ? other : next_corner(other));
      corners.join(next_corner(side), along ? next_corner(other) : other);
    }
    std::vector<std::uint32_t> out(places_.size());
    for (std::uint32_t corner = 0; corner < out.size(); ++corner) out[corner] = corners.find(corner);
    return out;
  }

 private:
  enum class State : std::uint8_t { kWhole, kWall, kLine, kTwin };  ///< kLine: two of its corners are one

  /// Corners in one cell are one.
  void find_places(double cell) {
    std::vector<std::pair<Cell, std::uint32_t>> cells(mesh_.vertices.size());
    for (std::uint32_t v = 0; v < cells.size(); ++v) {
      for (int k = 0; k < 3; ++k)
        cells[v].first[static_cast<std::size_t>(k)] = std::llround(mesh_.vertices[v][k] / cell);
      cells[v].second = v;
    }
    std::sort(cells.begin(), cells.end());
    std::vector<std::uint32_t> place(cells.size());
    for (std::size_t i = 0; i < cells.size(); ++i)
      place[cells[i].second] =
          i > 0 && cells[i].first == cells[i - 1].first ? place[cells[i - 1].second] : cells[i].second;
    places_.reserve(3 * mesh_.triangles.size());
    for (const auto& triangle : mesh_.triangles)
      for (const std::uint32_t v : triangle) places_.push_back(place[v]);
  }

  void find_triangles() {
    state_.assign(mesh_.triangles.size(), State::kWhole);
    std::vector<std::pair<Cell, std::uint32_t>> all(state_.size());
    for (std::uint32_t t = 0; t < all.size(); ++t) {
      Cell three{places_[3 * t], places_[3 * t + 1], places_[3 * t + 2]};
      std::sort(three.begin(), three.end());
      if (three[0] == three[1] || three[1] == three[2]) state_[t] = State::kLine;
      all[t] = {three, t};
    }
    std::sort(all.begin(), all.end());
    for (std::size_t i = 1; i < all.size(); ++i)
      if (all[i].first == all[i - 1].first && state_[all[i].second] != State::kLine)
        state_[all[i].second] = State::kTwin;
  }

  bool counts(std::uint32_t t) const { return state_[t] == State::kWhole || state_[t] == State::kWall; }

  void find_partners() {
    struct NumberedSide {
      std::uint32_t low, high, number;
    };
    std::vector<NumberedSide> sides;
    for (std::uint32_t side = 0; side < places_.size(); ++side)
      if (counts(side / 3)) {
        const auto [low, high] = std::minmax({places_[side], places_[next_corner(side)]});
        sides.push_back({low, high, side});
      }
    std::sort(sides.begin(), sides.end(), [](const NumberedSide& a, const NumberedSide& b) {
      return std::tie(a.low, a.high, a.number) < std::tie(b.low, b.high, b.number);
    });
    partner_.assign(places_.size(), kBorder);
    for (std::size_t i = 0, end = 0; i < sides.size(); i = end) {
      while (end < sides.size() && sides[end].low == sides[i].low && sides[end].high == sides[i].high) ++end;
      if (end - i != 2) continue;
      partner_[sides[i].number] = sides[i + 1].number;
      partner_[sides[i + 1].number] = sides[i].number;
    }
  }

  /// Turns the triangles of a piece as the first one is; where they come round and disagree, a border is
  /// left.
  void turn_alike() {
    turned_.assign(state_.size(), false);
    std::vector<bool> met(state_.size(), false);
    std::vector<std::uint32_t> next_ones;
    for (std::uint32_t first = 0; first < state_.size(); ++first) {
      if (met[first] || !counts(first)) continue;
      met[first] = true;
      next_ones.assign(1, first);
      while (!next_ones.empty()) {
        const std::uint32_t t = next_ones.back();
        next_ones.pop_back();
        for (std::uint32_t side = 3 * t; side < 3 * t + 3; ++side) {
          if (partner_[side] == kBorder) continue;
          const std::uint32_t other = partner_[side] / 3;
          // Of two that are turned alike one runs along the side, the other one back.
          const bool turned = turned_[t] != (places_[side] == places_[partner_[side]]);
          if (!met[other]) {
            met[other] = true;
            turned_[other] = turned;
            next_ones.push_back(other);
          } else if (turned_[other] != turned) {
            partner_[partner_[side]] = kBorder;
            partner_[side] = kBorder;
          }
        }
      }
    }
  }

  /// The mean over a piece's area, of so many of its triangles.
  static double encloses(const std::vector<std::uint32_t>& piece, const Enclosure& enclosure) {
    double sum = 0, area = 0;
    const std::size_t step = (piece.size() + kMostAsked - 1) / kMostAsked;
    for (std::size_t i = 0; i < piece.size(); i += step) {
      const double own = enclosure.area(piece[i]);
      area += own;
      sum += own * enclosure.at(piece[i]);
    }
    return area > 0 ? sum / area : 0;
  }

  void find_open(Enclosure* enclosure) {
    Components pieces(state_.size());
    for (std::uint32_t side = 0; side < partner_.size(); ++side)
      if (partner_[side] != kBorder) pieces.join(side / 3, partner_[side] / 3);
    std::vector<bool> open(state_.size(), false);
    for (std::uint32_t side = 0; side < partner_.size(); ++side)
      if (counts(side / 3) && partner_[side] == kBorder) open[pieces.find(side / 3)] = true;
    std::map<std::uint32_t, std::vector<std::uint32_t>> of_piece;
    for (std::uint32_t t = 0; t < state_.size(); ++t)
      if (counts(t) && open[pieces.find(t)]) of_piece[pieces.find(t)].push_back(t);
    // What surely is a sheet first, for it disturbs what is said of others.
    if (enclosure == nullptr) {
      for (const auto& [first, triangles] : of_piece) become_walls(triangles);
      return;
    }
    for (const double bound : {0.5 * kBoundsAnInside, 0.8 * kBoundsAnInside, kBoundsAnInside}) {
      std::vector<std::uint32_t> sheets;
      std::erase_if(of_piece, [&](const auto& piece) {
        const auto& triangles = piece.second;
        if (encloses(triangles, *enclosure) > bound) return false;
        become_walls(triangles);
        sheets.insert(sheets.end(), triangles.begin(), triangles.end());
        return true;
      });
      enclosure->take_for_sheets(sheets);
    }
    for (const auto& [first, triangles] : of_piece) spared_ += triangles.size();
  }

  void become_walls(const std::vector<std::uint32_t>& triangles) {
    for (const std::uint32_t t : triangles) state_[t] = State::kWall;
  }

  const Mesh& mesh_;
  std::vector<std::uint32_t> places_;  ///< by corner: vertices in one place have one number
  std::vector<State> state_;           ///< by triangle
  std::vector<std::uint32_t>
      partner_;               ///< by side: the only other one along the same edge; kBorder: a border
  std::vector<bool> turned_;  ///< by triangle
  std::size_t spared_ = 0;    ///< Thickened::spared
};

/// How far each joined corner goes out, by its number.
std::vector<Vec3> ways_out(const Mesh& mesh, const Sheets& sheets, const std::vector<std::uint32_t>& joined,
                           double half) {
  std::vector<Vec3> way(joined.size(), Vec3(0));
  std::vector<Vec3> normals(mesh.triangles.size(), Vec3(0));
  const auto place = [&](std::uint32_t corner) {
    return mesh.vertices[mesh.triangles[corner / 3][corner % 3]];
  };
  for (std::uint32_t t = 0; t < normals.size(); ++t) {
    if (!sheets.is_open(t)) continue;
    const auto at = sheets.corners(t);
    const Vec3 across = glm::cross(place(at[1]) - place(at[0]), place(at[2]) - place(at[0]));
    const double size = glm::length(across);
    if (!(size > 0)) continue;
    normals[t] = across / size;
    for (std::size_t k = 0; k < 3; ++k) {
      // By its angle each triangle counts as much, however finely a face is cut.
      const Vec3 a = place(at[(k + 1) % 3]) - place(at[k]), b = place(at[(k + 2) % 3]) - place(at[k]);
      way[joined[at[k]]] += std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) * normals[t];
    }
  }
  std::vector<double> cosine(joined.size(), 1);  // the least between the way and a normal
  for (Vec3& out : way)
    if (const double size = glm::length(out); size > 0) out /= size;
  for (std::uint32_t corner = 0; corner < joined.size(); ++corner)
    if (sheets.is_open(corner / 3) && normals[corner / 3] != Vec3(0))
      cosine[joined[corner]] =
          std::min(cosine[joined[corner]], glm::dot(way[joined[corner]], normals[corner / 3]));
  for (std::size_t i = 0; i < way.size(); ++i) way[i] *= half / std::max(cosine[i], kLeastCosine);
  return way;
}

}  // namespace

Thickened thicken(const Mesh& mesh, double thickness_m, Enclosure* enclosure) {
  Sheets sheets(mesh, thickness_m / 4096, enclosure);
  Thickened out;
  out.spared = sheets.spared();
  out.copies = sheets.copies();
  out.mesh.vertices = mesh.vertices;
  const std::vector<std::uint32_t> joined = sheets.joined_corners();
  const std::vector<Vec3> way = ways_out(mesh, sheets, joined, thickness_m / 2);
  std::vector<std::uint32_t> front(joined.size(),
                                   kBorder);  // vertex of a joined corner; the next one is its back
  for (std::uint32_t corner = 0; corner < joined.size(); ++corner) {
    if (!sheets.is_open(corner / 3)) continue;
    std::uint32_t& vertex = front[joined[corner]];
    if (vertex == kBorder) {
      vertex = static_cast<std::uint32_t>(out.mesh.vertices.size());
      const Vec3 middle = mesh.vertices[mesh.triangles[corner / 3][corner % 3]];
      out.mesh.vertices.push_back(middle + way[joined[corner]]);
      out.mesh.vertices.push_back(middle - way[joined[corner]]);
    }
  }
  auto& triangles = out.mesh.triangles;
  for (const MeshPart& part : mesh.parts) {
    MeshPart wall = part;
    wall.first_triangle = static_cast<std::uint32_t>(triangles.size());
    std::vector<std::array<std::uint32_t, 3>> backs, borders;
    for (std::uint32_t t = part.first_triangle; t < part.first_triangle + part.triangle_count; ++t) {
      if (sheets.is_copy(t)) continue;
      if (!sheets.is_open(t)) {
        triangles.push_back(mesh.triangles[t]);
        continue;
      }
      ++out.walls;
      const auto corners = sheets.corners(t);
      std::array<std::uint32_t, 3> face;
      for (std::size_t k = 0; k < 3; ++k) face[k] = front[joined[corners[k]]];
      triangles.push_back(face);
      backs.push_back({face[0] + 1, face[2] + 1, face[1] + 1});
      for (std::size_t k = 0; k < 3; ++k) {
        // The side of the two corners, whichever way the file runs along it.
        const std::uint32_t a = corners[k], b = corners[(k + 1) % 3], side = next_corner(a) == b ? a : b;
        if (!sheets.is_border(side)) continue;
        const std::uint32_t from = face[k], to = face[(k + 1) % 3];
        borders.push_back({to, from, from + 1});
        borders.push_back({to, from + 1, to + 1});
      }
    }
    triangles.insert(triangles.end(), backs.begin(), backs.end());
    triangles.insert(triangles.end(), borders.begin(), borders.end());
    wall.triangle_count = static_cast<std::uint32_t>(triangles.size()) - wall.first_triangle;
    out.mesh.parts.push_back(std::move(wall));
  }
  return out;
}

}  // namespace palpate
