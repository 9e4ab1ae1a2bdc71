// A recorded trace as a device, and what is no trace.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "driver/replay/replay_device.h"
#include "driver/replay/trace_file.h"

namespace palpate::replay {
namespace {

using testing::HasSubstr;

const std::string kHeader = "time_s,x_m,y_m,z_m,qx,qy,qz,qw,force_x_N,stage\n";

class TraceFile {
 public:
  explicit TraceFile(const std::string& text)
      : path_(testing::TempDir() + "trace_" + std::to_string(::getpid()) + "_" + std::to_string(++count_) +
              ".csv") {
    std::ofstream(path_, std::ios::binary) << text;
  }
  ~TraceFile() { std::filesystem::remove(path_); }
  const std::string& path() const { return path_; }

 private:
  static inline int count_ = 0;
  std::string path_;
};

/// The sentence of a file's error, its path taken out.
std::string fault_of(const std::string& text) {
  const TraceFile file(text);
  const auto rows = read_trace(file.path());
  if (rows) return "";
  EXPECT_EQ(rows.error().code, ErrorCode::kBadValue);
  std::string sentence = rows.error().sentence;
  const auto at = sentence.find(file.path());
  EXPECT_EQ(at, 0u) << sentence << ": the file is named first";
  return sentence.substr(file.path().size());
}

TEST(Replay, GivesTheRecordedPosesToTheBitAndTheMissedOnesBetween) {
  const TraceFile file(kHeader +
                       "0,0.1,0.2,0.3,0,0,0,1,5,1\n"
                       "0.001,0.30000000000000004,0.2,0.3,0,0,0.6,0.8,5,1\n"
                       "0.003,0.5,0.2,0.3,0,0,0.6,0.8,5,2\n");  // the recording missed 2 ms
  auto device = make_replay(file.path(), 8, 1);
  ASSERT_TRUE(device) << device.error().sentence;
  EXPECT_EQ((*device)->motion_s(), 0.003);
  EXPECT_EQ((*device)->read().state, DeviceState::kClosed);
  for (int round = 0; round < 2; ++round) {  // opened anew it begins anew
    ASSERT_TRUE((*device)->open());
    EXPECT_EQ((*device)->read().pose.position, Vec3(0.1, 0.2, 0.3));
    const DeviceSample second = (*device)->read();
    EXPECT_EQ(second.pose.position.x, 0.30000000000000004);
    EXPECT_EQ(second.pose.rotation, Quat(0.8, 0, 0, 0.6));
    EXPECT_EQ(second.stage, 1);
    EXPECT_NEAR((*device)->read().pose.position.x, 0.4, 1e-15);
    const DeviceSample last = (*device)->read();
    EXPECT_EQ(last.pose.position.x, 0.5);
    EXPECT_EQ(last.stage, 2);
    EXPECT_EQ((*device)->read().pose.position.x, 0.5) << "held at the end";
    (*device)->close();
  }
}

TEST(Replay, ExertsNothingAndSaysWhatADeviceCould) {
  const TraceFile file(kHeader + "0,0,0,0,0,0,0,1,0,0\n");
  auto device = make_replay(file.path(), 8, 1);
  ASSERT_TRUE(device);
  EXPECT_EQ((*device)->capabilities().max_force_n, 8);
  EXPECT_TRUE((*device)->capabilities().actuated[5]);
  EXPECT_EQ((*device)->motion_s(), 0);
}

TEST(Replay, WhatIsNoTraceIsRefusedWithItsLine) {
  const std::string good = "0,0,0,0,0,0,0,1,0,0\n";
  EXPECT_EQ(fault_of(kHeader + good), "");
  EXPECT_EQ(fault_of(""), ", line 1 is missing; it must begin with \"time_s,x_m,y_m,z_m,qx,qy,qz,qw\"");
  EXPECT_THAT(fault_of("time,x\n1,2\n"), HasSubstr(", line 1 is \"time,x\"; it must begin with"));
  EXPECT_EQ(fault_of(kHeader), " has no row below its header");
  EXPECT_EQ(fault_of(kHeader + good + "0.001,0,0,0,0,0\n"), ", line 3 has 6 values; the header has 10")
      << "a recording cut short";
  EXPECT_EQ(fault_of(kHeader + good + "0.001,0,zero,0,0,0,0,1,0,0\n"),
            ", line 3: \"zero\" is not a finite number");
  EXPECT_EQ(fault_of(kHeader + good + "0.001,0,nan,0,0,0,0,1,0,0\n"),
            ", line 3: \"nan\" is not a finite number");
  EXPECT_EQ(fault_of(kHeader + good + "0,0,0,0,0,0,0,1,0,0\n"),
            ", line 3: time 0 s must be above the one before, 0 s");
  EXPECT_EQ(fault_of(kHeader + "-1,0,0,0,0,0,0,1,0,0\n"), ", line 2: time -1 s is not from 0 to 1000000 s");
  EXPECT_EQ(fault_of(kHeader + "0,0,0,0,0,0,0,2,0,0\n"),
            ", line 2: the rotation's length is 2; a unit quaternion has length 1");
  EXPECT_EQ(fault_of(kHeader + "0,1e5,0,0,0,0,0,1,0,0\n"), ", line 2: position 1e+05 m is beyond 10000 m");
  EXPECT_EQ(fault_of(kHeader + "0,0,0,0,0,0,0,1,0,1.5\n"),
            ", line 2: stage 1.5 is not a whole number from 0 to 1000000");
  const auto none = read_trace("/nowhere/trace.csv");
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().sentence, "/nowhere/trace.csv cannot be opened");
  EXPECT_FALSE(read_trace(testing::TempDir())) << "a directory is no trace";
}

}  // namespace
}  // namespace palpate::replay
