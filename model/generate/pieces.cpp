#include "model/generate/pieces.h"

#include <algorithm>
#include <cmath>

#include "model/generate/turn.h"

namespace palpate::pieces {
namespace {

using solids::Ends;

/// Not std::hypot, whose last bit differs between C libraries.
double length_of(double x, double y) { return std::sqrt(x * x + y * y); }

std::uint64_t sum(const Divisions& divisions, std::size_t first, std::size_t count) {
  std::uint64_t total = 0;
  for (std::size_t i = first; i < first + count; ++i) total += divisions[i];
  return total;
}

/// All places of a grid line, the end of a span being the start of the next one; the very end only if
/// `with_end`.
std::vector<GridPlace> places(const Divisions& divisions, std::size_t first, std::size_t count,
                              bool with_end) {
  std::vector<GridPlace> out;
  for (std::size_t span = 0; span < count; ++span)
    for (std::uint32_t step = 0; step < divisions[first + span]; ++step)
      out.push_back({span, step, divisions[first + span]});
  if (with_end) out.push_back({count - 1, divisions[first + count - 1], divisions[first + count - 1]});
  return out;
}

Divisions divide(const Piece& piece, double cell) {
  Divisions divisions;
  for (const Span& span : piece.spans) {
    double cells = piece.fineness > 0 ? std::ceil(span.length / (cell * piece.fineness)) : 0;
    cells = std::min(cells, 1e6);
    divisions.push_back(std::max(span.least, static_cast<std::uint32_t>(cells)));
  }
  return divisions;
}

std::uint64_t count_all(const std::vector<Piece>& pieces, double cell) {
  std::uint64_t total = 0;
  for (const Piece& piece : pieces) total += piece.count(divide(piece, cell));
  return total;
}

/// Puts a point in the middle of `splits` triangles, spread evenly: two triangles more for each, still
/// closed.
void split_triangles(Mesh& mesh, std::uint64_t splits) {
  const std::uint64_t size = mesh.triangles.size();
  splits = std::min(splits, size);
  std::vector<std::array<std::uint32_t, 3>> triangles;
  triangles.reserve(size + 2 * splits);
  for (std::uint64_t t = 0; t < size; ++t) {
    const auto [a, b, c] = mesh.triangles[t];
    if ((t + 1) * splits / size == t * splits / size) {
      triangles.push_back({a, b, c});
      continue;
    }
    const auto m = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.push_back((mesh.vertices[a] + mesh.vertices[b] + mesh.vertices[c]) / 3.0);
    triangles.push_back({a, b, m});
    triangles.push_back({b, c, m});
    triangles.push_back({c, a, m});
  }
  mesh.triangles = std::move(triangles);
}

}  // namespace

Piece block(std::string name, const Vec3& min, const Vec3& max, double fineness, const Pose& pose) {
  const Vec3 size = max - min;
  Piece piece{std::move(name), fineness, {{size.x, 1}, {size.y, 1}, {size.z, 1}}, {}, {}};
  piece.count = [](const Divisions& n) {
    return 4 * (std::uint64_t{n[0]} * n[1] + std::uint64_t{n[1]} * n[2] + std::uint64_t{n[2]} * n[0]);
  };
  piece.make = [=](const Divisions& n) {
    return solids::moved(solids::box(min, max, Int3(n[0], n[1], n[2])), pose);
  };
  return piece;
}

Piece lofted(std::string name, double fineness, const std::vector<Span>& around,
             const std::vector<Span>& along, Ends ends,
             const std::function<Vec3(const GridPlace&, const GridPlace&)>& point) {
  Piece piece{std::move(name), fineness, around, {}, {}};
  piece.spans.insert(piece.spans.end(), along.begin(), along.end());
  const std::size_t n_around = around.size(), n_along = along.size();
  piece.count = [=](const Divisions& n) {
    return 2 * sum(n, 0, n_around) * (sum(n, n_around, n_along) + (ends == Ends::kPoints ? 1 : 0));
  };
  piece.make = [=](const Divisions& n) {
    const std::vector<GridPlace> loop_places = places(n, 0, n_around, false);
    std::vector<solids::Loop> loops;
    for (const GridPlace& v : places(n, n_around, n_along, ends == Ends::kPoints)) {
      solids::Loop& loop = loops.emplace_back();
      loop.reserve(loop_places.size());
      for (const GridPlace& u : loop_places) loop.push_back(point(u, v));
    }
    return solids::loft(loops, ends);
  };
  return piece;
}

Piece swept(std::string name, double fineness, const std::vector<Span>& section_spans,
            const std::function<std::pair<double, double>(const GridPlace&)>& section,
            const std::vector<Span>& spine_spans, const std::function<Pose(const GridPlace&)>& spine,
            double cap_m) {
  const std::size_t last = spine_spans.size() + 1;
  std::vector<Span> along{{cap_m, 1}};
  along.insert(along.end(), spine_spans.begin(), spine_spans.end());
  along.push_back({cap_m, 1});
  return lofted(std::move(name), fineness, section_spans, along, Ends::kPoints,
                [=](const GridPlace& u, const GridPlace& v) {
                  double scale = 1;
                  GridPlace on_spine{v.span - 1, v.step, v.steps};
                  if (v.span == 0) {
                    scale = static_cast<double>(v.step + 1) / (v.steps + 1);
                    on_spine = {0, 0, 1};
                  } else if (v.span == last) {
                    scale = static_cast<double>(v.steps - v.step + 1) / (v.steps + 1);
                    on_spine = {last - 2, 1, 1};
                  }
                  const Pose frame = spine(on_spine);
                  const auto [y, z] = section(u);
                  return frame.position + frame.rotation * Vec3(0, scale * y, scale * z);
                });
}

Piece framed_opening(std::string name, double fineness, std::vector<std::pair<double, double>> inner,
                     std::vector<std::pair<double, double>> outer, bool round_inside, double thickness,
                     const Pose& pose) {
  const std::size_t corners = inner.size();
  std::vector<Span> around;
  double web = 0;  // the widest stretch between the outlines
  for (std::size_t i = 0; i < corners; ++i) {
    const auto [y0, z0] = outer[i];
    const auto [y1, z1] = outer[(i + 1) % corners];
    around.push_back({length_of(y1 - y0, z1 - z0), round_inside ? 3u : 1u});
    web = std::max(web, length_of(inner[i].first - y0, inner[i].second - z0));
  }
  const auto on = [](const std::vector<std::pair<double, double>>& outline, const GridPlace& u) {
    const auto [y0, z0] = outline[u.span];
    const auto [y1, z1] = outline[(u.span + 1) % outline.size()];
    return std::pair(y0 + (y1 - y0) * u.fraction(), z0 + (z1 - z0) * u.fraction());
  };
  const auto point = [=](const GridPlace& u, const GridPlace& v) {
    auto in = on(inner, u);
    if (round_inside) {
      const double radius = length_of(inner[0].first, inner[0].second) / length_of(in.first, in.second);
      in = {in.first * radius, in.second * radius};
    }
    const auto out = on(outer, u);
    const double f = v.fraction();
    const double outward = v.span == 0 ? f : v.span == 1 ? 1 : v.span == 2 ? 1 - f : 0;
    const double x = v.span == 0 ? 0 : v.span == 1 ? f : v.span == 2 ? 1 : 1 - f;
    return pose.position + pose.rotation * Vec3(x * thickness, in.first + (out.first - in.first) * outward,
                                                in.second + (out.second - in.second) * outward);
  };
  return lofted(std::move(name), fineness, around, {{web, 1}, {thickness, 1}, {web, 1}, {thickness, 1}},
                Ends::kJoined, point);
}

Piece cylinder(std::string name, double fineness, double radius, double height, std::uint32_t least_segments,
               const Pose& pose) {
  const auto point = [=](const GridPlace& u, const GridPlace& v) {
    const Turn t = turn_by(u.fraction());
    double r = radius, z = height * v.fraction();
    if (v.span == 0) {
      r = radius * (v.step + 1) / (v.steps + 1);
      z = 0;
    } else if (v.span == 2) {
      r = radius * (v.steps - v.step + 1) / (v.steps + 1);
      z = height;
    }
    return pose.position + pose.rotation * Vec3(r * t.cos, r * t.sin, z);
  };
  return lofted(std::move(name), fineness, {{2 * kPi * radius, least_segments}},
                {{radius, 1}, {height, 1}, {radius, 1}}, Ends::kPoints, point);
}

Piece torus(std::string name, double fineness, double ring_radius, double tube_radius, const Pose& pose) {
  const auto point = [=](const GridPlace& u, const GridPlace& v) {
    const Turn round = turn_by(u.fraction()), tube = turn_by(v.fraction());
    const double r = ring_radius + tube_radius * tube.cos;
    return pose.position + pose.rotation * Vec3(r * round.cos, r * round.sin, tube_radius * tube.sin);
  };
  return lofted(std::move(name), fineness, {{2 * kPi * ring_radius, 12}}, {{2 * kPi * tube_radius, 8}},
                Ends::kJoined, point);
}

Mesh tessellate(std::vector<Piece> pieces, std::uint64_t triangles) {
  constexpr double kCoarsest = 1e3;  // m, so that every span has its least number of cells
  while (pieces.size() > 1 && count_all(pieces, kCoarsest) > triangles / 10 * 9) pieces.pop_back();

  // The cell size just coarse enough, then piece by piece the next finer step while there is room.
  double coarse = kCoarsest, fine = 1e-6;
  for (int i = 0; i < 100; ++i) {
    const double middle = std::sqrt(coarse * fine);
    (count_all(pieces, middle) <= triangles ? coarse : fine) = middle;
  }
  std::uint64_t total = count_all(pieces, coarse);
  std::vector<Divisions> divisions;
  std::size_t largest = 0;
  std::uint64_t largest_count = 0;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    divisions.push_back(divide(pieces[i], coarse));
    const Divisions finer = divide(pieces[i], fine);
    const std::uint64_t with_finer = total - pieces[i].count(divisions.back()) + pieces[i].count(finer);
    if (with_finer <= triangles) {
      divisions.back() = finer;
      total = with_finer;
    }
    if (pieces[i].count(divisions.back()) > largest_count) {
      largest_count = pieces[i].count(divisions.back());
      largest = i;
    }
  }

  Mesh mesh;
  mesh.triangles.reserve(triangles);
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    Mesh part = pieces[i].make(divisions[i]);
    if (i == largest) split_triangles(part, (triangles - total) / 2);
    solids::append(mesh, part, pieces[i].name);
  }
  return mesh;
}

}  // namespace palpate::pieces
