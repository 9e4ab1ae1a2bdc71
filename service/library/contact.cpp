// Lists of a lone pose of palpate.h.
#include "service/cli/answer.h"
#include "service/library/open_scene.h"
#include "service/queries/query_json.h"

using namespace palpate;
using namespace palpate::library;

struct palpate_contact {
  Answer answer;
  std::string json;
};

std::int32_t palpate_contact_at(palpate_scene* scene, const double* pose, palpate_contact** contact,
                                palpate_error** error) {
  if (contact) *contact = nullptr;
  return guarded(error, nullptr, [&]() -> Result<void> {
    if (!scene || !pose || !contact)
      return wrong_call("the scene, the pose or the place for the contact is null");
    const auto at = pose_at(pose, 0);
    if (!at) return at.error();
    auto out = std::make_unique<palpate_contact>();
    if (auto done = scene->ask_any([&](CollisionBackend& backend) {
          return answer_pose(scene->hosted().loaded, backend, *at, out->answer);
        });
        !done)
      return done;
    const TouchedParts parts(scene->geometry());
    append_query_line({.number = 0,
                       .total_us = out->answer.total_us,
                       .batch = std::nullopt,
                       .tick = std::nullopt,
                       .parts = &parts,
                       .pose = &*at},
                      out->answer.contacts, out->answer.response, out->json);
    out->json.pop_back();  // the line feed
    *contact = out.release();
    return {};
  });
}

void palpate_contact_free(palpate_contact* contact) { delete contact; }

const std::uint32_t* palpate_contact_list(const palpate_contact* contact, std::int32_t list,
                                          std::size_t* count) {
  if (count) *count = 0;
  if (!contact) return nullptr;
  const Contacts& known = contact->answer.contacts;
  const std::vector<std::uint32_t>* const lists[] = {&known.cst, &known.bst, &known.cmt,
                                                     &known.bmt, &known.imt, &known.est};
  if (list < 0 || static_cast<std::size_t>(list) >= std::size(lists)) return nullptr;
  const std::vector<std::uint32_t>& found = *lists[list];
  if (count) *count = found.size();
  return found.data();
}

const char* palpate_contact_json(const palpate_contact* contact) {
  return contact ? contact->json.c_str() : "";
}
