#pragma once

#include "firmware/model/types.h"

namespace sidestep {

/// The shortest rotation from the z axis to `axis`, which is not zero. For -z it is the half turn about x.
Quaternion rotation_from_z(const Vector3& axis);

}  // namespace sidestep
