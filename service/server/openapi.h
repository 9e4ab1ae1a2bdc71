#pragma once
#include <string_view>

namespace palpate::assets {

extern const std::string_view openapi_json;  ///< service/server/openapi.json

}  // namespace palpate::assets
