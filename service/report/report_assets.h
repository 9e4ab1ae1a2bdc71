#pragma once
#include <string_view>

/// What the report pages are made of, embedded at build time (scripts/cmake/EmbedText.cmake).
namespace palpate::assets {

extern const std::string_view report_html, report_css, report_js;
extern const std::string_view plot_js;  ///< charts of lines, for report_js

}  // namespace palpate::assets
