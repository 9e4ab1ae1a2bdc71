// One spelling of a frame for `query` and frames.jsonl.
#include <gtest/gtest.h>

#include <limits>

#include "service/queries/query_json.h"

namespace palpate {
namespace {

TEST(QueryLine, HasTheContractsFieldsInItsOrder) {
  Contacts contacts;
  contacts.contact = true;
  contacts.pairs = 3;
  contacts.cst = {1, 2};
  contacts.imt = {9};
  contacts.times = {{"detect", 12.5}};
  ContactArea area;
  area.id = 1;
  area.zones = {{1}, {2}};
  area.static_ids = {1, 2};
  area.mobile_ids = {9};
  contacts.areas = {area};
  ContactResponse response;
  AreaResponse of_area;
  of_area.normal = Vec3(0, 0, 1);
  of_area.depth = 0.1;
  of_area.flags = kFlagCancelled | kFlagSheet;
  response.areas = {of_area};
  response.wrench.force = Vec3(0, 0, 1.0 / 3);
  response.flags = kFlagCancelled;
  contacts.engine = "gpu";
  std::string out;
  append_query_line({4, 20, std::nullopt, 12}, contacts, response, out);
  EXPECT_EQ(
      out,
      R"({"number":4,"contact":true,"pairs":3,"cst":[1,2],"bst":[],"cmt":[],"bmt":[],"imt":[9],"est":[],)"
      R"("areas":[{"id":1,"zones":[[1],[2]],"static":[1,2],"mobile":[9],"normal":[0,0,1],"depth":0.1,"point":[0,0,0],)"
      R"("force":[0,0,0],"torque":[0,0,0],"flags":["cancelled","sheet"]}],)"
      R"("force":[0,0,0.3333333333333333],"torque":[0,0,0],"flags":["cancelled"],"truncated":false,"engine":"gpu",)"
      R"("time_us":{"total":20,"detect":12.5},"tick":12})"
      "\n");
  out.clear();
  append_query_line({.number = 4, .batch = std::nullopt, .tick = std::nullopt, .area_lists = false}, contacts,
                    response, out);
  EXPECT_NE(out.find(R"("cst":[1,2])"), std::string::npos) << out;
  EXPECT_NE(out.find(R"("areas":[{"id":1,"normal":[0,0,1],)"), std::string::npos) << out;
}

TEST(QueryLine, TellsWhatIsFeltAndWhereTheToolIsMeanwhile) {
  ContactResponse response;
  response.wrench.force = Vec3(0, 0, 80);
  response.felt = Felt{.wrench = {Vec3(0, 0, 2), Vec3(0.5, 0, 0)},
                       .tool = {Vec3(1, 2, 3), Quat(1, 0, 0, 0)},
                       .evaluations = 5};
  std::string out;
  append_query_line({}, Contacts{}, response, out);
  EXPECT_NE(
      out.find(
          R"("force":[0,0,2],"torque":[0.5,0,0],"flags":[],"tool":[1,2,3,0,0,0,1],"evaluations":5,"truncated":false)"),
      std::string::npos)
      << out;
}

TEST(QueryLine, TellsWhichNamedPartsTouch) {
  SceneGeometry geometry;
  const auto part = [](const char* path, std::uint32_t triangles) {
    MeshReport::Part out;
    out.path = path;
    out.triangles = triangles;
    return out;
  };
  geometry.mockup_report.parts = {part("engine/block", 10), part("engine/lid \"1\"", 5),
                                  part("engine/bolt", 5)};
  geometry.tool_report.parts = {part("hand", 3), part("finger", 3)};
  const TouchedParts parts(geometry);
  Contacts contacts;
  contacts.cst = {9, 10, 11};  // the block's last and the lid's first
  contacts.cmt = {3};
  std::string out;
  append_query_line({.batch = std::nullopt, .tick = std::nullopt, .parts = &parts}, contacts,
                    ContactResponse{}, out);
  EXPECT_NE(out.find(R"("parts":{"static":["engine/block","engine/lid \"1\""],"tool":["finger"]},"areas":)"),
            std::string::npos)
      << out;
  contacts = {};
  contacts.areas.resize(1);
  contacts.areas[0].static_ids = {19};  // enclosed: in no pair, but in an area
  contacts.areas[0].mobile_ids = {0};
  out.clear();
  append_query_line({.batch = std::nullopt, .tick = std::nullopt, .parts = &parts}, contacts,
                    ContactResponse{}, out);
  EXPECT_NE(out.find(R"("parts":{"static":["engine/bolt"],"tool":["hand"]})"), std::string::npos) << out;
}

TEST(QueryLine, ABatchIsNamed) {
  std::string out;
  append_query_line({0, 1, 64, std::nullopt}, Contacts{}, ContactResponse{}, out);
  EXPECT_NE(out.find(R"("time_us":{"total":1},"batch":64})"), std::string::npos) << out;
}

TEST(QueryLine, ANumberThatIsNotFiniteIsNullSoThatTheLineStaysJson) {
  ContactResponse response;
  response.wrench.force.x = std::numeric_limits<double>::infinity();
  response.wrench.force.y = std::numeric_limits<double>::quiet_NaN();
  std::string out;
  append_query_line({}, Contacts{}, response, out);
  EXPECT_NE(out.find(R"("force":[null,null,0])"), std::string::npos) << out;
}

}  // namespace
}  // namespace palpate
