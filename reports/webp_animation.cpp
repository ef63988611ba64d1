#include "reports/webp_animation.h"

#include <webp/encode.h>
#include <webp/mux.h>

#include <stdexcept>

namespace gradwright {

struct WebpAnimation::State {
    WebPAnimEncoder* encoder = nullptr;
    WebPConfig config;
    int width = 0, height = 0, now = 0;
    ~State() { WebPAnimEncoderDelete(encoder); }
    [[noreturn]] void fail(const std::string& what) const {
        const char* why = encoder ? WebPAnimEncoderGetError(encoder) : nullptr;
        throw std::runtime_error("animated picture: " + what + (why && *why ? std::string(": ") + why : ""));
    }
};

WebpAnimation::WebpAnimation(int width, int height, float quality) : state_(std::make_unique<State>()) {
    WebPAnimEncoderOptions options;
    if (!WebPAnimEncoderOptionsInit(&options) || !WebPConfigInit(&state_->config))
        state_->fail("libwebp is of another version than its headers");
    options.anim_params.loop_count = 0;
    options.kmax = 0;  // no further whole pictures: looking for them encodes every picture twice
    state_->config.quality = quality;
    state_->config.method = 3;  // of 0 to 6: 4 takes twice as long for 3 % of the bytes
    state_->width = width;
    state_->height = height;
    state_->encoder = WebPAnimEncoderNew(width, height, &options);
    if (!state_->encoder) state_->fail("no room for it");
}

WebpAnimation::~WebpAnimation() = default;

void WebpAnimation::add(const std::uint8_t* pixels, int stride, int milliseconds) {
    WebPPicture picture;
    if (!WebPPictureInit(&picture)) state_->fail("libwebp is of another version than its headers");
    picture.use_argb = 1;
    picture.width = state_->width;
    picture.height = state_->height;
    const bool kept = WebPPictureImportBGRX(&picture, pixels, stride) != 0 &&
                      WebPAnimEncoderAdd(state_->encoder, &picture, state_->now, &state_->config) != 0;
    WebPPictureFree(&picture);
    if (!kept) state_->fail("a picture was refused");
    state_->now += milliseconds;
}

std::string WebpAnimation::finish() {
    WebPData data;
    WebPDataInit(&data);
    if (state_->now == 0 || !WebPAnimEncoderAdd(state_->encoder, nullptr, state_->now, nullptr) ||
        !WebPAnimEncoderAssemble(state_->encoder, &data))
        state_->fail("it cannot be put together");
    std::string bytes(reinterpret_cast<const char*>(data.bytes), data.size);
    WebPDataClear(&data);
    return bytes;
}

}  // namespace gradwright
