// Pictures shown one after the other, as an animated WebP (RIFF container, ANIM and ANMF chunks; lossy VP8
// frames), by libwebp. The bytes depend on the pictures, the times and the library's version alone.
#pragma once
#include <cstdint>
#include <memory>
#include <string>

namespace gradwright {

class WebpAnimation {
  public:
    /// `width`, `height` [px], 1 to 16383; `quality` 0 (small) to 100. Throws std::runtime_error.
    WebpAnimation(int width, int height, float quality);
    ~WebpAnimation();
    /// One picture, shown for `milliseconds`: rows of opaque 32-bit pixels, blue in the lowest byte, as cairo
    /// has them, `stride` bytes a row. Throws std::runtime_error.
    void add(const std::uint8_t* pixels, int stride, int milliseconds);
    /// The file's bytes; it loops for ever. Throws std::runtime_error, without a picture too.
    std::string finish();

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace gradwright
