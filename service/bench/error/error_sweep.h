#pragma once
#include <array>
#include <string>
#include <vector>

#include "model/collision_backend.h"
#include "service/bench/error/error_subjects.h"

namespace palpate {

/// A way of working out the response: a profile and what is turned up or down.
struct ErrorSetting {
  Profile profile = Profile::kRefined;
  std::string knob;  ///< "sample_spacing", "voxel_size", "contact_samples", "triangles"
  double value = 0;  ///< m, or a number of triangles
  GeometrySettings geometry;
  std::uint64_t triangles = 0;  ///< the mock-up is cut into about so many; 0: as it is
};

/// What is measured at a pose, and its unit in tables.
inline constexpr std::array<const char*, 5> kErrorQuantities = {"d_m", "n_c_deg", "cp_m", "F_N", "T_Nm"};

struct ErrorResult {
  std::array<std::vector<double>, 5>
      errors;                    ///< one a pose that has a truth; absolute, in the unit of kErrorQuantities
  std::vector<double> times_us;  ///< one a pose: the fastest of the rounds
  std::size_t lost =
      0;  ///< poses where the truth has a contact and the answer none; their n_c and cp do not count
  std::uint64_t samples = 0;  ///< rays of all poses
  DeviceWork work{};          ///< as in Answered
};

/// The response of the setting at each pose; empty where there is no contact. `rounds`: how often each pose
/// is asked and timed; `cpu_clock`: by the time that this process itself ran. Errors: the geometry can't be
/// built or prepared; the back end failed; interrupted.
struct Answered {
  std::vector<std::optional<ContactTruth>> answers;
  std::vector<double> times_us;             ///< the fastest of the rounds
  std::vector<std::vector<double>> all_us;  ///< every round's
  std::uint64_t samples = 0;
  DeviceWork work;  ///< what a frame asks of a device: medians
};
Result<Answered> answer_all(const ErrorSubject& subject, const ErrorSetting& setting, std::uint64_t rounds,
                            CollisionBackend& backend, const Progress& progress, bool cpu_clock = false);

/// Holds answers against the truth. At a pose with several areas d, n_c and cp are the deepest area's, F and
/// T the whole pose's.
ErrorResult judge(const Answered& answered, const std::vector<std::optional<ContactTruth>>& truths);

/// Nearest rank; 0 of nothing.
double percentile(std::vector<double> values, double fraction);

}  // namespace palpate
