// Holds answers of a server against the schemas of its own openapi.json. Reads one JSON object, {"openapi":
// …, "answers": [{"schema": "Scene", "answer": …}, …]}, from standard input; exit 1 with a sentence for each
// that does not fit.
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validation_results.hpp>
#include <valijson/validator.hpp>

int main() {
  using nlohmann::json;
  const json input = json::parse(std::cin);
  int wrong = 0;
  for (const json& item : input.at("answers")) {
    const std::string name = item.at("schema");
    if (!input.at("openapi").at("components").at("schemas").contains(name)) {
      std::printf("there is no schema %s\n", name.c_str());
      return 1;
    }
    const json root = {{"allOf", json::array({{{"$ref", "#/components/schemas/" + name}}})},
                       {"components", input.at("openapi").at("components")}};
    valijson::Schema schema;
    valijson::SchemaParser parser;
    parser.populateSchema(valijson::adapters::NlohmannJsonAdapter(root), schema);
    valijson::Validator validator(valijson::Validator::kStrongTypes);
    valijson::ValidationResults results;
    if (validator.validate(schema, valijson::adapters::NlohmannJsonAdapter(item.at("answer")), &results))
      continue;
    ++wrong;
    std::printf("%s does not fit: %s\n", name.c_str(), item.at("answer").dump().substr(0, 2000).c_str());
    valijson::ValidationResults::Error error;
    while (results.popError(error)) {
      for (const std::string& place : error.context) std::printf("%s", place.c_str());
      std::printf(": %s\n", error.description.c_str());
    }
  }
  return wrong == 0 ? 0 : 1;
}
