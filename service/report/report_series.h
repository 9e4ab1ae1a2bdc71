#pragma once
#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "service/loop/run_record.h"
#include "service/report/force_steps.h"
#include "service/report/work_given.h"

namespace palpate {

/// Stretches of time of which nothing was recorded, in bounded memory: the shortest are forgotten first.
class Gaps {
 public:
  /// Ascending, none within another.
  void push(double begin, double end);
  /// Those that a chart over `span` shows, in order.
  std::vector<std::array<double, 2>> seen_over(double span) const;

 private:
  static constexpr std::size_t kMost = 2048;  ///< chosen
  static constexpr double kSeen = 1.0 / 400;  ///< of a chart: some two pixels of a wide screen

  std::vector<std::array<double, 2>> gaps_;
};

/// A long curve in bounded memory: while it fits every point is kept; then neighbouring points share a bin
/// that keeps its smallest, largest and mean value, so no peak is lost. x must ascend.
class Envelope {
 public:
  void push(double x, double y);

  /// JSON `[[x,y],…]`: each bin's smallest and largest point, in the order of x; null is the y in a gap.
  void append_extremes(std::string& out, const Gaps& gaps = {}) const;
  /// JSON `[[x,mean],…]`; likewise.
  void append_means(std::string& out, const Gaps& gaps = {}) const;

 private:
  static constexpr std::size_t kBins = 800;  ///< about a bin a pixel of a wide screen (chosen)

  struct Bin {
    double first_x = 0, min_x = 0, max_x = 0, min = 0, max = 0, sum = 0;
    std::uint32_t count = 0;
  };
  void merge_pairs();
  double span() const;

  std::vector<Bin> bins_;
  std::uint32_t bin_size_ = 1;
};

/// The ticks around the strongest contact response of a run, at full rate; with a stage those around its
/// largest torque about x, which the chapter's figure 13 shows of its third.
class Highlight {
 public:
  explicit Highlight(std::optional<std::int32_t> stage = {}) : stage_(stage) {}
  void push(const TickRecord& tick);
  /// Empty if the run had no contact.
  std::vector<TickRecord> ticks() const;

 private:
  static constexpr std::size_t kTicks = 200;  ///< the chapter's Fig. 13 shows frames 3450–3650

  std::optional<std::int32_t> stage_;
  std::deque<TickRecord> recent_;
  std::vector<TickRecord> best_;
  double strongest_ = 0;            ///< N, largest response force so far; with a stage N·m
  std::size_t until_complete_ = 0;  ///< ticks still wanted after the strongest one; 0: nothing pending
};

/// What the report says of one stage of the path.
struct StageFigures {
  std::int64_t ticks = 0, frames = 0;
  double force_max_n = 0, torque_max_nm = 0;  ///< of the response
  /// The tool's at the largest force, without any at its last frame; without frames the device's of ticks.
  Pose pose;
  double at_s = 0;
  double frame_force_max_n = 0;  ///< of frames
  std::size_t areas_max = 0, triangles_max = 0;
  double frame_us_sum = 0, frame_us_max = 0;
};

/// What a report looks at beside the forces.
struct ReportFocus {
  Vec3 tool_gc_m{0};                    ///< tool frame, for work
  std::optional<std::int32_t> stage{};  ///< of the stretch at full rate (Highlight)
};

/// Collects the report's curves during a run, in bounded memory.
class ReportSeries : public RunObserver {
 public:
  explicit ReportSeries(const ReportFocus& focus = {}) : highlight_(focus.stage), work_(focus.tool_gc_m) {}
  Result<void> on_tick(const TickRecord& tick) override;
  Result<void> on_frame(const FrameRecord& frame) override;

  /// The members "curves", "stage_us", "highlight", "roughness", "stages" and "stage_figures" of the report's
  /// data, without braces around.
  std::string json(const std::vector<std::string>& stage_names) const;

  /// By number of the stage; 0 is what lies between.
  std::map<std::int32_t, StageFigures> stages() const;

 private:
  struct Section {
    std::int32_t stage;
    double begin_s, end_s;
  };
  struct FrameFigures {
    double time_s, total_us, force_n;
    Pose pose;
    std::size_t areas, triangles;
  };
  void add_frame(const FrameFigures& frame, std::map<std::int32_t, StageFigures>& to) const;

  std::map<std::string, Envelope> tick_curves_;   ///< by name: "response_force_x", …
  std::map<std::string, Envelope> frame_curves_;  ///< "cst", "frame_us", …
  std::vector<std::string> time_stages_;          ///< in the order of a frame
  std::map<std::string, Envelope> stage_us_;      ///< by the back end's name of the stage
  std::vector<Section> sections_;
  std::map<std::int32_t, StageFigures> figures_;
  Gaps frame_gaps_;
  double last_frame_s_ = 0;
  std::deque<FrameFigures> waiting_;  ///< frames whose ticks have not come yet, oldest first
  Highlight highlight_;
  WorkGiven work_;
  ForceSteps steps_sent_, steps_without_;  ///< with the control law, and without
};

}  // namespace palpate
