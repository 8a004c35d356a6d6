#include "firmware/control/types/settings.h"

namespace sidestep {

void use_law(Settings& settings, Law law) {
  settings.law = law;
  if (law != Law::kPaper) return;
  settings.shield.enabled = false;
  settings.foresight.enabled = false;
  settings.timeouts.coast_s = 0.0;
  settings.bounds_target_speed = false;
  settings.estimates_motion = false;
}

}  // namespace sidestep
