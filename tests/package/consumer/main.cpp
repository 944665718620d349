#include <cmath>
#include <cstdio>

#include "abbe/base/constants.h"
#include "abbe/optics/dispersion.h"

int main() {
  // SCHOTT N-BK7, data sheet: n_d = 1.51680.
  const abbe::SellmeierFormula n_bk7{.B = {1.03961212, 0.231792344, 1.01046945},
                                     .C = {0.00600069867, 0.0200179144, 103.560653}};
  const double n_d = abbe::refractive_index(n_bk7, abbe::kLine_d_nm);
  std::printf("n_d of N-BK7: %.5f\n", n_d);
  return std::abs(n_d - 1.51680) < 1e-5 ? 0 : 1;  // The data sheet's five decimals.
}
