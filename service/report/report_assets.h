#pragma once
#include <string_view>

/// What the report page is made of, embedded at build time (scripts/cmake/EmbedText.cmake).
namespace palpate::assets {

extern const std::string_view report_html, report_css, report_js;
extern const std::string_view bench_html, bench_js;  ///< uses report_css
extern const std::string_view chart_js;  ///< Chart.js as Debian packages it, MIT licence, notice inside

}  // namespace palpate::assets
