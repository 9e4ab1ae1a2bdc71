#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "model/collision_backend.h"
#include "model/result.h"
#include "service/bench/bench.h"
#include "service/cli/cli.h"
#include "service/cli/console.h"
#include "service/report/chart_svg.h"

namespace palpate {

/// A value of a row; an empty string is "none" (null in JSON, nothing in CSV).
using BenchCell = std::variant<std::string, double, std::uint64_t>;

/// Empty where there is none.
inline BenchCell cell_of(const std::optional<double>& value) {
  return value ? BenchCell(*value) : BenchCell(std::string());
}

/// The columns of what is asked of a device, and a row's cells there: empty where no device was asked.
inline const std::vector<std::string> kWorkColumns = {"submissions", "dispatches", "barriers",
                                                      "bytes_up",    "bytes_down", "host_us"};
std::vector<BenchCell> work_cells(const DeviceWork& work);

struct BenchTable {
  std::vector<std::string> columns;
  std::vector<std::vector<BenchCell>> rows;
};

/// What figures belong to.
struct BenchFacts {
  /// Names a device beside those that are there; nothing if it is there already.
  void add_device(const std::string& text);

  std::string command;  ///< "latency"
  std::string device;   ///< the back ends' devices and drivers
  std::vector<std::pair<std::string, std::string>>
      more;  ///< of this bench: scenes, poses, versions of libraries
  std::vector<std::pair<std::string, std::string>> findings =
      {};  ///< sentences that the figures say, with the chapter they stand in; empty: at the top
};

/// The engine, and name and driver of its device: "gpu on llvmpipe (LLVM 15.0.6, 256 bits), llvmpipe
/// Mesa 22.3.6 (LLVM 15.0.6)". Call after the back end was made: listing devices is not allowed before.
std::string device_text(const CollisionBackend& backend, const Parts& parts);

/// Mean number of processes that wanted to run in the last minute; −1: unknown.
double load_average();

/// The first back end of the options, else the program's own choice; its device and the machine's load are
/// noted in `facts`.
Result<std::unique_ptr<CollisionBackend>> bench_backend(const BenchOptions& options, const Parts& parts,
                                                        Console& console, BenchFacts& facts);

/// Writes results.csv, results.json, report.html and chart_N.svg to `directory` (made if
/// missing), each with machine, device, commit and version, and prints the table. CSV: `table`'s columns and
/// then machine, device, commit.
Result<void> write_bench(const std::string& directory, const BenchFacts& facts, const BenchTable& table,
                         const std::vector<Chart>& charts);

}  // namespace palpate
