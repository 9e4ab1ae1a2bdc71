// All engines behind one interface: what scenes with known answers are asked of the reference is asked of the
// others as well.
#include <gtest/gtest.h>

#include <stdexcept>

#include "compute/gpu/gpu_backend.h"
#include "compute/native/native_backend.h"
#include "cpu_ref/ref_backend.h"
#include "tests/cpu_ref/bench_backend.h"
#include "tests/equivalence/contacts_difference.h"

namespace palpate {
namespace {

/// Answers with the device's contacts; a difference from the reference's, or from the native engine's in
/// `refined`, is a test failure.
class PairedBackend final : public CollisionBackend {
 public:
  PairedBackend() : reference_(make_ref_backend()), native_(make_native_backend()) {
    GpuOptions options;
    options.validation = true;
    auto made = make_gpu_backend(options);
    if (!made) throw std::runtime_error(made.error().sentence);
    device_ = std::move(*made);
  }
  Result<void> prepare(const SceneGeometry& geometry, const Plan& plan, const Progress& progress) override {
    if (auto prepared = reference_->prepare(geometry, plan, progress); !prepared) return prepared;
    refined_ = plan.profile == Profile::kRefined;
    if (refined_)
      if (auto prepared = native_->prepare(geometry, plan, progress); !prepared) return prepared;
    return device_->prepare(geometry, plan, progress);
  }
  Result<void> query(const LatticePose& pose, const Ignored* ignored, Contacts& out) override {
    if (auto answered = reference_->query(pose, ignored, expected_); !answered) return answered;
    if (auto answered = device_->query(pose, ignored, out); !answered) return answered;
    EXPECT_EQ(first_difference(out, expected_), "") << "(gpu, ref)";
    if (!refined_) return {};
    if (auto answered = native_->query(pose, ignored, by_native_); !answered) return answered;
    EXPECT_EQ(first_difference(by_native_, expected_), "") << "(cpu, ref)";
    return {};
  }
  Result<VoxelPartition> partition(bool tool) const override { return device_->partition(tool); }
  bool has_internal_voxels() const override { return device_->has_internal_voxels(); }
  std::string name() const override { return "all"; }
  std::string device() const override { return device_->device(); }
  std::uint64_t memory_bytes() const override { return device_->memory_bytes() + reference_->memory_bytes(); }

 private:
  std::unique_ptr<CollisionBackend> reference_, native_, device_;
  bool refined_ = false;
  Contacts expected_, by_native_;
};

}  // namespace

std::unique_ptr<CollisionBackend> make_bench_backend() { return std::make_unique<PairedBackend>(); }

}  // namespace palpate
