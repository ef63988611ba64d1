// A freely cooling gas of smooth grains, periodic in x, y and z. Shared by rung V12 and its plot. Private.
#pragma once
#include <vector>

#include "dem/verification/laboratory.h"

namespace gradwright::verification {

/// Time over tau and temperature over the first one; `expected` by the gas theory (physics: Haff 1983).
struct CoolingPoint {
    double time = 0, temperature = 0, expected = 0;
};

struct CoolingOptions {
    int cells = 14;  ///< grains along each edge: cells^3 in all; the scatter of 1000 is 2 %
    double packing_fraction = 0.1, restitution = 0.8;
    double end = 1;  ///< [tau]
    int points = 8;
};
std::vector<CoolingPoint> cool(const VerificationOptions& options, const CoolingOptions& cooling);

}  // namespace gradwright::verification
