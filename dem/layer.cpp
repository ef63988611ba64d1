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

Layer pooled(std::span<const Layer> layers) {
    Layer all = layers.front();
    const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
    for (const Layer& layer : layers.subspan(1)) {
        append(all.origin_x, layer.origin_x);
        append(all.origin_y, layer.origin_y);
        append(all.origin_z, layer.origin_z);
        append(all.deposit_x, layer.deposit_x);
        append(all.deposit_y, layer.deposit_y);
        append(all.deposit_z, layer.deposit_z);
        append(all.volume, layer.volume);
        append(all.radius, layer.radius);
        append(all.is_a, layer.is_a);
        all.gap += layer.gap;
        all.dosed_solid_volume += layer.dosed_solid_volume;
        all.overflow_solid_volume += layer.overflow_solid_volume;
        all.overflow_solid_volume_a += layer.overflow_solid_volume_a;
    }
    return all;
}

}  // namespace gradwright
