#pragma once
#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "model/lattice/pose.h"

namespace palpate {

/// The shortest text that reads back as the same double.
std::string printed(double value);

/// A row below a CSV file's header. Errors (kBadValue) name file, line, value and what is allowed.
class CsvRow {
 public:
  CsvRow(const std::string& file, std::size_t number, std::vector<std::string_view> cells)
      : file_(file), number_(number), cells_(std::move(cells)) {}

  std::string place() const { return file_ + ", line " + std::to_string(number_); }
  std::size_t size() const { return cells_.size(); }
  Result<double> number(std::size_t column) const;  ///< finite
  Result<double> time(std::size_t column) const;    ///< s, from 0 to 10^6
  Result<int> stage(std::size_t column) const;      ///< a whole number from 0 to 10^6
  /// x y z qx qy qz qw from a column on: within 10 km of the origin (a scene is below 100 m or warned about),
  /// the rotation unit within kUnitQuaternionTolerance and left as it stands.
  Result<Pose> pose(std::size_t column) const;

 private:
  const std::string& file_;
  std::size_t number_;
  std::vector<std::string_view> cells_;  // without the spaces round them
};

/// The columns that a file must have, and whether others may follow.
struct CsvHeader {
  std::string_view columns;
  bool more = false;
};

/// Gives each row below the header to `take`, lines in order, empty ones passed over, each with as many cells
/// as the header. No quotes; a byte order mark and CR LF are borne. `names`: all of the header's, told once
/// before the first row. The first error ends it: the file's (kBadValue, naming file, line, what it is and
/// what it must be) or the caller's.
Result<void> read_csv(const std::string& file, const CsvHeader& header,
                      const std::function<void(const std::vector<std::string_view>& names)>& names,
                      const std::function<Result<void>(const CsvRow& row)>& take);

}  // namespace palpate
