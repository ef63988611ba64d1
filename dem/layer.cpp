#include "dem/layer.h"

namespace gradwright {

double Layer::solid_volume() const {
    double sum = 0;
    for (double v : volume) sum += v;
    return sum;
}

double Layer::capture_fraction() const {
    return dosed_solid_volume > 0 ? solid_volume() / dosed_solid_volume : 0;
}

double Layer::packing_fraction() const {
    const double room = gap * platform_length * width;
    return room > 0 ? solid_volume() / room : 0;
}

}  // namespace gradwright
