#pragma once
#include <cstdint>
#include <vector>

#include "compute/gpu/frame/capacity.h"
#include "compute/gpu/frame/recorder.h"
#include "compute/gpu/prepare/prepared_scene.h"
#include "compute/vulkan/device.h"
#include "model/contact/contacts.h"
#include "model/result.h"
#include "model/scene/plan.h"
#include "model/scene/scene_geometry.h"
#include "shaders/shared/frame_field.h"

namespace palpate {

/// `refined`: the response half of a frame, the pressure field (docs/EXACTNESS.md section 8), from the lists
/// that detection leaves. Owns pipelines; its buffers live in FrameBuffers. Allocates when made, not when a
/// frame runs.
class FrameField {
 public:
  /// Makes the pipelines; `batch`: of a batch (shaders/shared/frame_batch.h). Geometry outlives this.
  static Result<FrameField> create(VulkanDevice& device, const SceneGeometry& geometry,
                                   const PreparedScene& scene, const Plan& plan, bool batch = false);

  /// Makes its buffers in `buffers`; those that are large enough already stay. Before the first record(), and
  /// again when the capacity has grown. Error: one buffer is beyond a limit, or out of memory.
  Result<void> make_buffers(VulkanDevice& device, const FrameCapacity& capacity, FrameBuffers& buffers);

  /// Records every dispatch, from the lists that detection has left to the results and the tables as they
  /// were.
  void record(FrameRecorder& recorder) const;
  /// Of a batch that only asks whether there is contact: the poses' states and the tables as they were.
  void record_touch(FrameRecorder& recorder) const;

  /// Puts down for the next frame what is ignored; null: nothing. Writes only what has changed. True: some
  /// patch is.
  bool ignore(const Ignored* ignored, const FrameBuffers& buffers);

  /// Fills field, carriers, ignored_touched and flags of an answer whose sets are decoded, in contact, not
  /// truncated. `statics`: C_s by slot.
  void decode(const FrameBuffers& buffers, const gpu::FrameResult& result, Contacts& out);

 private:
  const SceneGeometry* geometry_ = nullptr;
  Plan plan_;
  FrameShader members_, points_, from_mockup_, from_tool_, result_, touch_result_;
  bool inside_ = true;                       ///< the tool has one
  std::vector<std::uint32_t> ignored_;       ///< what the bits say
  std::vector<std::uint32_t> ignored_bits_;  ///< as the device has them
};

/// Fills the field and its flags of an answer in contact.
void decode_field(const gpu::FieldWork& work, Contacts& out);
/// Adds what a static triangle carries, if it is one that does. After the last one they are to be put in
/// order.
void add_carrier(const gpu::StaticResult& of, const gpu::CarrierWork& work, Contacts& out);
void order_carriers(Contacts& out);

}  // namespace palpate
