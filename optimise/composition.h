// From GI to composition: mass fraction of powder A and wt% of each element, of the powder as laid and of the
// metal after melting. Validity: nominal alloy compositions, nothing evaporates, the powder's solid volume
// shares are its GI.
//
//   mass fraction      m = rA g / (rA g + rB (1 - g))                   r = solid density of the alloy, g =
//   GI by volume element e          wt_e = m a_e + (1 - m) b_e                       a, b = wt% of e in A and
//   B
//
// Melting (width W across y, depth D from the top of the new layer, layer thickness t):
//   across y           one track is well mixed: mean of m over a window of width W, weighted by the mass that
//   lies there;
//                      bins count as uniform, so W up to one bin changes nothing, for a bin already is such a
//                      mean
//   into the depth     each new layer (share t/D of the pool) mixes fully with the D - t of metal below,
//   which the track
//                      before it left uniform: c_n = (t/D) p_n + (1 - t/D) c_(n-1)
//   many layers alike  c -> p: dilution does not change the mean profile of a part that is graded across y
//   only. It fades out
//                      what lies below, (1 - t/D)^n of the base plate is left in layer n, and it evens out
//                      the layers' scatter by the factor sqrt(a / (2 - a)), a = t/D.
// Assumes that a pool mixes fully and that neighbouring tracks overlap without further exchange.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "dem/gradation.h"
#include "dem/material.h"

namespace gradwright {

/// The pool that the laser makes.
struct MeltPool {
    double depth =
        0;  ///< D from the top of the new layer [m], >= layer_thickness: a shallower one does not bond
    double width = 0;            ///< W across y [m], > 0
    double layer_thickness = 0;  ///< t of dense metal that each layer adds [m], > 0

    double new_share() const { return layer_thickness / depth; }
    /// Share of what lay under the first layer that is left in layer n = 1, 2, ... [-]
    double base_share(int layer) const;
    /// What is left of the scatter from layer to layer, as a factor on its standard deviation [-].
    double scatter_factor() const;
};

/// One quantity over the bins with its band; NaN where undefined.
struct BandedProfile {
    std::vector<double> value, low, high;
};

struct ElementProfile {
    std::string element;  ///< "Fe"
    BandedProfile wt;     ///< [wt%]
};

struct Composition {
    std::vector<double> y_m;        ///< bin centres [m]
    BandedProfile mass_fraction_a;  ///< [-]
    std::vector<ElementProfile>
        elements;  ///< every element of either alloy, in falling share; Fe and Ni always
    /// Of `element`; throws std::out_of_range.
    const BandedProfile& wt(const std::string& element) const;
};

/// Half width of the simultaneous 95 % band of a profile's GI in standard errors, over its defined bins.
double band_factor(const GradationProfile& profile);

/// Powder as laid. `factor`: half width of the band in standard errors of the GI (band_factor); the
/// band of GI, clipped to [0, 1], is carried through the two formulas, both monotone. Throws
/// std::invalid_argument naming the material without a composition.
Composition powder_composition(const GradationProfile& profile, const std::array<Material, 2>& alloys,
                               double factor);

/// Metal after melting, as above. Band: errors of the bins, taken as independent, through the mean over the
/// window. Depth does not narrow it: every layer is predicted from the one measured profile. Throws as
/// powder_composition, and when depth, width or layer thickness break their rule.
Composition melted_composition(const GradationProfile& profile, const std::array<Material, 2>& alloys,
                               double factor, const MeltPool& pool);

/// m of a GI by volume [-].
double mass_fraction_a(double gi, double density_a, double density_b);

}  // namespace gradwright
