#include "host/campaign/search/search_report.h"

#include <fmt/format.h>

#include "host/campaign/search/finding_file.h"

namespace sidestep::campaign {
namespace {

constexpr double kMilli = 1e-3;

}  // namespace

std::string scene_report(const SearchScene& scene, const ClosestApproach& closest, double witness_clearance_m) {
  return fmt::format("{}: least clearance {:.1f} mm at {:.2f} s; the witness keeps {:.1f} mm\n", name_of(scene.family),
                     closest.clearance_m / kMilli, closest.t_s, witness_clearance_m / kMilli);
}

std::string search_report(const SearchSpace& space, const std::string& law, const SearchResult& result) {
  constexpr char kLine[] = "{:<8} {:<10} {:>9} {:>8} {:>10} {:>15} {:>16}\n";
  std::string text =
      fmt::format(kLine, "search", "law", "obstacles", "runs", "contacts", "with a witness", "least clearance");
  text += fmt::format(kLine, name_of(space.family), law, space.obstacles, result.runs, result.contacts,
                      result.findings.size(), fmt::format("{:.1f} mm", result.least_clearance_m / kMilli));
  for (const Finding& finding : result.findings)
    text += fmt::format("\nchain {}, run {}, {}{}\n", finding.chain, finding.run,
                        scene_report(finding.scene, finding.closest, finding.witness_clearance_m),
                        to_yaml(finding.scene, finding.witness));
  return text;
}

}  // namespace sidestep::campaign
