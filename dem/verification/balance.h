// A whole small spread whose energy is accounted for. Shared by rung V16 and its plot. Private.
#pragma once
#include "dem/energy_ledger.h"
#include "dem/spread.h"
#include "dem/verification/laboratory.h"

namespace gradwright::verification {

/// A machine of a millimetre and a half, the paper's powders without fines: some hundred grains, all of
/// physics.md 1.
Scene balance_scene(const VerificationOptions& options);

}  // namespace gradwright::verification
