#pragma once

#include "firmware/model/arm.h"

namespace sidestep::campaign {

/// Distance of the point p to a segment, which may be a point, m.
double distance_to_segment(const Vector3& start, const Vector3& end, const Vector3& p);

/// Distance between two segments, m.
double segment_distance(const Vector3& a_start, const Vector3& a_end, const Vector3& b_start, const Vector3& b_end);

}  // namespace sidestep::campaign
