#include "service/report/report_series.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>

#include "service/report/run_summary.h"

namespace palpate {
namespace {

constexpr std::array<char, 3> kAxes = {'x', 'y', 'z'};

void append_point(double x, double y, std::string& out) {
  if (out.back() != '[') out.push_back(',');
  // Five digits are finer than a pixel. A value that is not finite is a gap.
  if (std::isfinite(y))
    fmt::format_to(std::back_inserter(out), "[{:.7g},{:.5g}]", x, y);
  else
    fmt::format_to(std::back_inserter(out), "[{:.7g},null]", x);
}

/// Writes a curve's points as JSON, with a null between two points that have a gap between them.
class GappedLine {
 public:
  GappedLine(const Gaps& gaps, double span, std::string& out) : gaps_(gaps.seen_over(span)), out_(out) {
    out_.push_back('[');
  }
  GappedLine(const GappedLine&) = delete;
  GappedLine& operator=(const GappedLine&) = delete;
  ~GappedLine() { out_.push_back(']'); }

  void point(double x, double y) {
    for (; next_ < gaps_.size() && gaps_[next_][1] <= x; ++next_) {
      const auto [begin, end] = gaps_[next_];
      if (any_ && last_x_ <= begin) append_point((begin + end) / 2, std::nan(""), out_), last_x_ = end;
    }
    append_point(x, y, out_);
    any_ = true;
    last_x_ = x;
  }

 private:
  std::vector<std::array<double, 2>> gaps_;
  std::string& out_;
  std::size_t next_ = 0;
  bool any_ = false;
  double last_x_ = 0;
};

}  // namespace

void Gaps::push(double begin, double end) {
  if (gaps_.size() == kMost) {
    std::vector<double> widths;
    for (const auto& gap : gaps_) widths.push_back(gap[1] - gap[0]);
    const auto middle = widths.begin() + kMost / 2;
    std::nth_element(widths.begin(), middle, widths.end());
    // Half of them are as long as the middle one or longer, so none that goes would be seen.
    std::erase_if(gaps_, [&](const auto& gap) { return gap[1] - gap[0] <= *middle; });
  }
  gaps_.push_back({begin, end});
}

std::vector<std::array<double, 2>> Gaps::seen_over(double span) const {
  std::vector<std::array<double, 2>> out;
  std::copy_if(gaps_.begin(), gaps_.end(), std::back_inserter(out),
               [&](const auto& gap) { return gap[1] - gap[0] >= kSeen * span; });
  return out;
}

double Envelope::span() const { return bins_.empty() ? 0 : bins_.back().max_x - bins_.front().first_x; }

void Envelope::push(double x, double y) {
  if (bins_.empty() || bins_.back().count >= bin_size_) {
    if (bins_.size() == kBins) merge_pairs();
    if (bins_.empty() || bins_.back().count >= bin_size_) {
      bins_.push_back({x, x, x, y, y, y, 1});
      return;
    }
  }
  Bin& bin = bins_.back();
  if (y < bin.min) bin.min = y, bin.min_x = x;
  if (y > bin.max) bin.max = y, bin.max_x = x;
  bin.sum += y;
  ++bin.count;
}

void Envelope::merge_pairs() {
  for (std::size_t i = 0; i < bins_.size() / 2; ++i) {
    Bin merged = bins_[2 * i];
    const Bin& other = bins_[2 * i + 1];
    if (other.min < merged.min) merged.min = other.min, merged.min_x = other.min_x;
    if (other.max > merged.max) merged.max = other.max, merged.max_x = other.max_x;
    merged.sum += other.sum;
    merged.count += other.count;
    bins_[i] = merged;
  }
  static_assert(kBins % 2 == 0);
  bins_.resize(bins_.size() / 2);
  bin_size_ *= 2;
}

void Envelope::append_extremes(std::string& out, const Gaps& gaps) const {
  GappedLine line(gaps, span(), out);
  for (const Bin& bin : bins_) {
    const bool rising = bin.min_x <= bin.max_x;
    line.point(rising ? bin.min_x : bin.max_x, rising ? bin.min : bin.max);
    if (bin.min != bin.max) line.point(rising ? bin.max_x : bin.min_x, rising ? bin.max : bin.min);
  }
}

void Envelope::append_means(std::string& out, const Gaps& gaps) const {
  GappedLine line(gaps, span(), out);
  for (const Bin& bin : bins_) line.point(bin.first_x, bin.sum / bin.count);
}

void Highlight::push(const TickRecord& tick) {
  recent_.push_back(tick);
  if (recent_.size() > kTicks) recent_.pop_front();
  const double strength = !stage_                 ? glm::length(tick.response.force)
                          : tick.stage == *stage_ ? std::fabs(tick.response.torque.x)
                                                  : 0;
  if (strength > strongest_) {
    strongest_ = strength;
    until_complete_ = kTicks / 2 + 1;
  }
  if (until_complete_ > 0 && --until_complete_ == 0) best_.assign(recent_.begin(), recent_.end());
}

std::vector<TickRecord> Highlight::ticks() const {
  if (until_complete_ > 0) return {recent_.begin(), recent_.end()};  // the run ended soon after
  return best_;
}

Result<void> ReportSeries::on_tick(const TickRecord& tick) {
  for (int i = 0; i < 3; ++i) {
    const char axis = kAxes[static_cast<std::size_t>(i)];
    tick_curves_[fmt::format("response_force_{}", axis)].push(tick.time_s, tick.response.force[i]);
    tick_curves_[fmt::format("response_torque_{}", axis)].push(tick.time_s, tick.response.torque[i]);
    tick_curves_[fmt::format("sent_force_{}", axis)].push(tick.time_s, tick.sent.force[i]);
    tick_curves_[fmt::format("sent_torque_{}", axis)].push(tick.time_s, tick.sent.torque[i]);
  }
  tick_curves_["energy"].push(tick.time_s, work_.push(tick));
  steps_sent_.push(tick.sent.force);
  steps_without_.push(tick.uncontrolled.force);
  highlight_.push(tick);
  if (sections_.empty() || sections_.back().stage != tick.stage)
    sections_.push_back({tick.stage, tick.time_s, tick.time_s});
  sections_.back().end_s = tick.time_s + kTickSeconds;

  for (; !waiting_.empty() && waiting_.front().time_s < sections_.back().end_s; waiting_.pop_front())
    add_frame(waiting_.front(), figures_);
  StageFigures& figures = figures_[tick.stage];
  ++figures.ticks;
  if (const double force = glm::length(tick.response.force);
      figures.frames == 0 && (force > figures.force_max_n || figures.force_max_n == 0))
    figures.pose = tick.pose, figures.at_s = tick.time_s;
  figures.force_max_n = std::max(figures.force_max_n, glm::length(tick.response.force));
  figures.torque_max_nm = std::max(figures.torque_max_nm, glm::length(tick.response.torque));
  return {};
}

Result<void> ReportSeries::on_frame(const FrameRecord& frame) {
  const double time_s = static_cast<double>(frame.tick) * kTickSeconds;
  if (frame.after_gap) frame_gaps_.push(last_frame_s_, time_s);
  last_frame_s_ = time_s;
  const Contacts& contacts = frame.contacts;
  const auto count = [&](const char* name, std::size_t n) {
    frame_curves_[name].push(time_s, static_cast<double>(n));
  };
  count("cst", contacts.cst.size());
  count("bst", contacts.bst.size());
  count("est", contacts.est.size());
  count("cmt", contacts.cmt.size());
  count("bmt", contacts.bmt.size());
  count("imt", contacts.imt.size());
  count("triangles", contacts.cst.size() + contacts.bst.size() + contacts.est.size() + contacts.cmt.size() +
                         contacts.bmt.size() + contacts.imt.size());
  const auto with_force = std::count_if(frame.response.areas.begin(), frame.response.areas.end(),
                                        [](const AreaResponse& area) { return area.force != Vec3(0); });
  count("areas", static_cast<std::size_t>(with_force));
  double depth = 0;
  for (const AreaResponse& area : frame.response.areas) depth = std::max(depth, area.depth);
  frame_curves_["depth"].push(time_s, depth);
  frame_curves_["frame_us"].push(time_s, frame.total_us);
  for (const Contacts::StageTime& time : contacts.times) {
    auto [curve, is_new] = stage_us_.try_emplace(time.stage);
    if (is_new) time_stages_.emplace_back(time.stage);
    curve->second.push(time_s, time.us);
  }
  // no time spent is a time, too: a curve must not run straight on to the stage's next turn
  for (auto& stage : stage_us_)
    if (std::none_of(contacts.times.begin(), contacts.times.end(),
                     [&](const Contacts::StageTime& time) { return time.stage == stage.first; }))
      stage.second.push(time_s, 0);

  // A frame belongs to the stage of its tick, whose record may still be on its way.
  waiting_.push_back({time_s, frame.total_us, glm::length(frame.response.wrench.force), frame.pose,
                      static_cast<std::size_t>(with_force),
                      contacts.cst.size() + contacts.bst.size() + contacts.est.size() + contacts.cmt.size() +
                          contacts.bmt.size() + contacts.imt.size()});
  return {};
}

/// To the figures of the stage in which it lies; before the first tick that is the first one.
void ReportSeries::add_frame(const FrameFigures& frame, std::map<std::int32_t, StageFigures>& to) const {
  auto section = sections_.rbegin();
  while (std::next(section) != sections_.rend() && frame.time_s < section->begin_s) ++section;
  StageFigures& figures = to[section->stage];
  if (frame.force_n > figures.frame_force_max_n || figures.frame_force_max_n == 0)
    figures.pose = frame.pose, figures.at_s = frame.time_s, figures.frame_force_max_n = frame.force_n;
  ++figures.frames;
  figures.areas_max = std::max(figures.areas_max, frame.areas);
  figures.triangles_max = std::max(figures.triangles_max, frame.triangles);
  figures.frame_us_sum += frame.total_us;
  figures.frame_us_max = std::max(figures.frame_us_max, frame.total_us);
}

std::map<std::int32_t, StageFigures> ReportSeries::stages() const {
  std::map<std::int32_t, StageFigures> out = figures_;
  if (!sections_.empty())
    for (const FrameFigures& frame : waiting_) add_frame(frame, out);
  return out;
}

std::string ReportSeries::json(const std::vector<std::string>& stage_names) const {
  std::string out = "\"curves\":{";
  const auto name = [&](const std::string& text) {
    if (out.back() != '{') out.push_back(',');
    out += nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + ":";
  };
  for (const auto& [key, curve] : tick_curves_) {
    name(key);
    curve.append_extremes(out);
  }
  for (const auto& [key, curve] : frame_curves_) {
    name(key);
    curve.append_extremes(out, frame_gaps_);
  }
  out += "},\"stage_us\":{";
  for (const std::string& stage : time_stages_) {
    name(stage);
    stage_us_.at(stage).append_means(out, frame_gaps_);
  }
  out += "},\"highlight\":[";
  for (const TickRecord& tick : highlight_.ticks()) {
    if (out.back() != '[') out.push_back(',');
    fmt::format_to(std::back_inserter(out), "[{:.7g}", tick.time_s);
    for (const Wrench* wrench : {&tick.uncontrolled, &tick.sent})
      for (const Vec3* v : {&wrench->force, &wrench->torque})
        for (int i = 0; i < 3; ++i)
          fmt::format_to(std::back_inserter(out), ",{:.6g}", std::isfinite((*v)[i]) ? (*v)[i] : 0.0);
    out.push_back(']');
  }
  out += "],\"roughness\":{";
  for (const auto& [key, steps] : {std::pair{"without", &steps_without_}, {"with", &steps_sent_}}) {
    name(key);
    fmt::format_to(std::back_inserter(out), "{{\"largest\":{:.5g},\"still\":{},\"steps\":", steps->largest(),
                   steps->still());
    steps->append_steps(out);
    out += ",\"spectrum\":";
    steps->append_spectrum(out);
    out.push_back('}');
  }
  out += "},\"stages\":";
  nlohmann::json stages = nlohmann::json::array();
  for (const Section& section : sections_)
    stages.push_back({{"stage", section.stage},
                      {"name", section.stage > 0 ? stage_text(section.stage, stage_names) : ""},
                      {"begin", section.begin_s},
                      {"end", section.end_s}});
  out += stages.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  out += ",\"stage_figures\":";
  nlohmann::json rows = nlohmann::json::array();
  for (const auto& [stage, figures] : this->stages())
    rows.push_back({{"stage", stage},
                    {"name", stage > 0 ? stage_text(stage, stage_names) : "between"},
                    {"seconds", static_cast<double>(figures.ticks) * kTickSeconds},
                    {"force_max", figures.force_max_n},
                    {"torque_max", figures.torque_max_nm},
                    {"areas_max", figures.areas_max},
                    {"triangles_max", figures.triangles_max},
                    {"frame_us_mean",
                     figures.frames > 0 ? figures.frame_us_sum / static_cast<double>(figures.frames) : 0.0},
                    {"frame_us_max", figures.frame_us_max}});
  out += rows.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  return out;
}

}  // namespace palpate
