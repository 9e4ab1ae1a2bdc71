#include "cpu_ref/box_tree.h"

#if PALPATE_EMBREE >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <new>
#include <stdexcept>

namespace palpate::cpu_ref {
namespace {

/// Steps by which every box grows. Coordinates reach 2^28 and rays are followed for 2^29, in numbers of 24
/// bits: an origin is off by up to 2^4, a direction of relative error 2^-24 by 2^5 at its end, the slab test
/// by a few times that. Chosen: 2^9.
constexpr float kMargin = 512;

/// Where Embree's memory counts that this thread takes and gives back, bytes; null: nowhere.
thread_local std::int64_t* counted_at = nullptr;

/// One device for the program. Embree's threads=1 alone does not keep its collisions to one thread; see
/// in_one_thread.
RTCDevice device() {
  struct Holder {
    RTCDevice device = rtcNewDevice("threads=1");
    Holder() {
      if (device == nullptr) return;
      rtcSetDeviceMemoryMonitorFunction(
          device,
          [](void*, ssize_t bytes, bool) {
            if (counted_at != nullptr) *counted_at += bytes;
            return true;
          },
          nullptr);
    }
    ~Holder() { rtcReleaseDevice(device); }
  };
  static Holder holder;
  if (holder.device == nullptr) {
    if (rtcGetDeviceError(nullptr) == RTC_ERROR_UNSUPPORTED_CPU)
      throw std::runtime_error("Embree does not know this processor");
    throw std::bad_alloc();  // what else keeps it from starting
  }
  return holder.device;
}

/// Keeps TBB's workers out, so that a callback that appends to a list is never run twice at once.
template <class Work>
void in_one_thread(const Work& work) {
  tbb::task_arena arena(1);
  arena.execute(work);
}

#if PALPATE_EMBREE >= 4
using RayContext = RTCRayQueryContext;
#else
using RayContext = RTCIntersectContext;
#endif

/// What a ray or a point gathers; first member, so that Embree's context pointer is a pointer to it.
struct Gathering {
  RayContext context;
  std::vector<std::uint32_t>* found = nullptr;
};

}  // namespace

struct BoxTree::Embree {
  std::vector<Box> boxes;
  RTCScene scene = nullptr;
  RTCGeometry geometry = nullptr;
  std::int64_t bytes = 0;  ///< that Embree has taken for the hierarchy
};

BoxTree::BoxTree() : embree_(std::make_unique<Embree>()) {
  RTCGeometry geometry = rtcNewGeometry(device(), RTC_GEOMETRY_TYPE_USER);
  rtcSetGeometryUserData(geometry, embree_.get());
  rtcSetGeometryBoundsFunction(
      geometry,
      [](const RTCBoundsFunctionArguments* arguments) {
        const Box& box = static_cast<const Embree*>(arguments->geometryUserPtr)->boxes[arguments->primID];
        RTCBounds& out = *arguments->bounds_o;
        if (box.min.x > box.max.x) {  // Embree leaves out what has lower > upper
          out.lower_x = out.lower_y = out.lower_z = std::numeric_limits<float>::infinity();
          out.upper_x = out.upper_y = out.upper_z = -std::numeric_limits<float>::infinity();
          return;
        }
        out.lower_x = static_cast<float>(box.min.x) - kMargin;
        out.lower_y = static_cast<float>(box.min.y) - kMargin;
        out.lower_z = static_cast<float>(box.min.z) - kMargin;
        out.upper_x = static_cast<float>(box.max.x) + kMargin;
        out.upper_y = static_cast<float>(box.max.y) + kMargin;
        out.upper_z = static_cast<float>(box.max.z) + kMargin;
      },
      nullptr);
  // Both gather the number and report no hit, so that the ray goes on.
  rtcSetGeometryIntersectFunction(geometry, [](const RTCIntersectFunctionNArguments*) {});
  rtcSetGeometryOccludedFunction(geometry, [](const RTCOccludedFunctionNArguments* arguments) {
    reinterpret_cast<Gathering*>(arguments->context)->found->push_back(arguments->primID);
  });
  embree_->geometry = geometry;
  embree_->scene = rtcNewScene(device());
  rtcSetSceneFlags(embree_->scene, RTC_SCENE_FLAG_ROBUST);
  rtcAttachGeometry(embree_->scene, geometry);
}

BoxTree::~BoxTree() {
  rtcReleaseScene(embree_->scene);
  rtcReleaseGeometry(embree_->geometry);
}

void BoxTree::build(std::vector<Box> boxes) {
  embree_->boxes = std::move(boxes);
  in_one_thread([this] {
    counted_at = &embree_->bytes;
    rtcSetGeometryUserPrimitiveCount(embree_->geometry, static_cast<unsigned>(embree_->boxes.size()));
    rtcCommitGeometry(embree_->geometry);
    rtcCommitScene(embree_->scene);
    counted_at = nullptr;
  });
  if (rtcGetDeviceError(device()) != RTC_ERROR_NONE)
    throw std::runtime_error("Embree could not build a hierarchy of boxes.");
}

void BoxTree::along_ray(const Int3& origin, const Int3& direction, std::vector<std::uint32_t>& found) const {
  Gathering gathering;
  gathering.found = &found;
  // A direction of length about 1 keeps Embree's reciprocals in range; only candidates depend on its
  // rounding.
  const Vec3 along(direction);
  const double largest = std::max({std::fabs(along.x), std::fabs(along.y), std::fabs(along.z)});
  RTCRay ray{};
  ray.org_x = static_cast<float>(origin.x);
  ray.org_y = static_cast<float>(origin.y);
  ray.org_z = static_cast<float>(origin.z);
  ray.dir_x = static_cast<float>(along.x / largest);
  ray.dir_y = static_cast<float>(along.y / largest);
  ray.dir_z = static_cast<float>(along.z / largest);
  ray.tnear = 0;
  ray.tfar = std::numeric_limits<float>::infinity();
  ray.mask = ~0u;
#if PALPATE_EMBREE >= 4
  rtcInitRayQueryContext(&gathering.context);
  RTCOccludedArguments arguments;
  rtcInitOccludedArguments(&arguments);
  arguments.context = &gathering.context;
  rtcOccluded1(embree_->scene, &ray, &arguments);
#else
  rtcInitIntersectContext(&gathering.context);
  rtcOccluded1(embree_->scene, &gathering.context, &ray);
#endif
}

void BoxTree::meeting(const Box& box, std::vector<std::uint32_t>& found) const {
  if (box.min.x > box.max.x) return;
  struct Query {
    const Box& box;
    const std::vector<Box>& boxes;
    std::vector<std::uint32_t>& found;
  } query_data{box, embree_->boxes, found};
  const Vec3 low(box.min), high(box.max);
  const Vec3 centre = 0.5 * (low + high), half = 0.5 * (high - low);
  RTCPointQuery query{};
  query.x = static_cast<float>(centre.x);
  query.y = static_cast<float>(centre.y);
  query.z = static_cast<float>(centre.z);
  query.radius =
      static_cast<float>(std::sqrt(half.x * half.x + half.y * half.y + half.z * half.z)) * 1.001f + kMargin;
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  const std::size_t first = found.size();
  rtcPointQuery(
      embree_->scene, &query, &context,
      [](RTCPointQueryFunctionArguments* arguments) {
        const Query& data = *static_cast<const Query*>(arguments->userPtr);
        if (data.boxes[arguments->primID].meets(data.box)) data.found.push_back(arguments->primID);
        return false;  // the radius stays
      },
      &query_data);
  std::sort(found.begin() + static_cast<std::ptrdiff_t>(first), found.end());
}

void BoxTree::meeting_pairs(const BoxTree& a, const BoxTree& b,
                            std::vector<std::pair<std::uint32_t, std::uint32_t>>& found) {
  if (a.embree_->boxes.empty() || b.embree_->boxes.empty()) return;
  struct Query {
    const std::vector<Box>& a;
    const std::vector<Box>& b;
    std::vector<std::pair<std::uint32_t, std::uint32_t>>& found;
  } query_data{a.embree_->boxes, b.embree_->boxes, found};
  const std::size_t first = found.size();
  in_one_thread([&] {
    rtcCollide(
        a.embree_->scene, b.embree_->scene,
        [](void* user, RTCCollision* collisions, unsigned count) {
          const Query& data = *static_cast<const Query*>(user);
          for (unsigned i = 0; i < count; ++i)
            if (data.a[collisions[i].primID0].meets(data.b[collisions[i].primID1]))
              data.found.emplace_back(collisions[i].primID0, collisions[i].primID1);
        },
        &query_data);
  });
  std::sort(found.begin() + static_cast<std::ptrdiff_t>(first), found.end());
}

/// Of Embree what it has said, while the hierarchy was built, that it took and gave back.
std::uint64_t BoxTree::memory_bytes() const {
  return embree_->boxes.capacity() * sizeof(Box) +
         static_cast<std::uint64_t>(std::max(embree_->bytes, std::int64_t{0}));
}

}  // namespace palpate::cpu_ref
