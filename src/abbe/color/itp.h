/// IC_TC_P of ITU-R BT.2100 and the colour difference in it.
#pragma once

#include "abbe/math/vec.h"

namespace abbe {

/// Signal of the perceptual quantiser for a luminance, and back.
/// Units:  cd/m²; the signal is 1 at 10 000 cd/m².
/// Domain: negative luminances count as 0; signals in [0, 1].
/// Source: SMPTE ST 2084:2014.
double pq_encode(double luminance_cd_per_m2);
double pq_decode(double signal);

/// I, C_T, C_P of tristimulus values, white D65.
/// Units:  XYZ in cd/m².
/// Domain: any; cone responses below 0 count as 0.
/// Source: ITU-R BT.2100-2, table 7, by way of the BT.2020 primaries.
Vec3d ictcp_of_xyz(const Vec3d& xyz_cd_per_m2);

/// 720·√(ΔI² + ΔT² + ΔP²), T = C_T/2: 1 is the threshold of visibility for the most critical eye.
/// Source: ITU-R BT.2124-0.
double delta_e_itp(const Vec3d& ictcp_a, const Vec3d& ictcp_b);

}  // namespace abbe
