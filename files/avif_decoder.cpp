#include "files/avif_decoder.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#ifdef RELUMINE_HDR_PHOTOS
#include <avif/avif.h>

#include "files/parallel.h"
#endif

namespace relumine::files {

bool is_avif(std::span<const std::byte> file) {
    const std::string_view head(reinterpret_cast<const char*>(file.data()),
                                std::min<std::size_t>(file.size(), 64));
    return head.size() >= 16 && head.substr(4, 4) == "ftyp" &&
           head.find("avi", 8) != std::string_view::npos;
}

#ifdef RELUMINE_HDR_PHOTOS

namespace {

void require(avifResult result) {
    if (result != AVIF_RESULT_OK)
        throw std::runtime_error(std::string("expected a whole AVIF picture, got ") +
                                 avifResultToString(result));
}

} // namespace

struct AvifPicture::Impl {
    std::unique_ptr<avifDecoder, void (*)(avifDecoder*)> decoder{avifDecoderCreate(),
                                                                 avifDecoderDestroy};
    bool is_decoded = false;
};

AvifPicture::AvifPicture(std::span<const std::byte> file) : impl_(std::make_unique<Impl>()) {
    avifDecoder& decoder = *impl_->decoder;
    decoder.maxThreads = static_cast<int>(num_threads());
    decoder.imageSizeLimit = 1U << 28; // the library's own
    decoder.strictFlags = AVIF_STRICT_DISABLED;
    require(avifDecoderSetIOMemory(&decoder, reinterpret_cast<const std::uint8_t*>(file.data()),
                                   file.size()));
    require(avifDecoderParse(&decoder));
    const avifImage& image = *decoder.image;
    head_ = {.width = image.width,
             .height = image.height,
             .num_bits = image.depth,
             .has_alpha = decoder.alphaPresent != AVIF_FALSE,
             .is_turned = (image.transformFlags & (AVIF_TRANSFORM_IROT | AVIF_TRANSFORM_IMIR)) != 0,
             .transfer = image.transferCharacteristics};
    avifColorPrimariesGetValues(image.colorPrimaries, head_.primaries.data());
}

void AvifPicture::decode(std::span<std::uint8_t> values, bool with_alpha) const {
    decode(values, 8, with_alpha);
}

void AvifPicture::decode(std::span<std::uint16_t> values, bool with_alpha) const {
    decode({reinterpret_cast<std::uint8_t*>(values.data()), values.size_bytes()}, 16, with_alpha);
}

void AvifPicture::decode(std::span<std::uint8_t> bytes, std::uint32_t num_bits,
                         bool with_alpha) const {
    const std::size_t channel = num_bits / 8;
    const std::size_t row = head_.width * (with_alpha ? 4 : 3) * channel;
    if (bytes.size() != row * head_.height)
        throw std::invalid_argument("expected room for the pixels of an AVIF picture");
    if (head_.has_alpha && !with_alpha) { // libavif would blend them onto black
        std::vector<std::uint8_t> whole(bytes.size() / 3 * 4);
        decode(whole, num_bits, true);
        for (std::size_t from = 0, to = 0; to < bytes.size();
             from += 4 * channel, to += 3 * channel)
            std::copy_n(&whole[from], 3 * channel, &bytes[to]);
        return;
    }
    if (!impl_->is_decoded)
        require(avifDecoderNextImage(impl_->decoder.get()));
    impl_->is_decoded = true;
    avifRGBImage rgb;
    avifRGBImageSetDefaults(&rgb, impl_->decoder->image);
    if (rgb.width != head_.width || rgb.height != head_.height)
        require(AVIF_RESULT_INVALID_IMAGE_GRID);
    rgb.depth = num_bits;
    rgb.format = with_alpha ? AVIF_RGB_FORMAT_RGBA : AVIF_RGB_FORMAT_RGB;
    rgb.pixels = bytes.data();
    rgb.rowBytes = static_cast<std::uint32_t>(row);
    require(avifImageYUVToRGB(impl_->decoder->image, &rgb));
}

AvifPicture::~AvifPicture() = default;
AvifPicture::AvifPicture(AvifPicture&&) noexcept = default;

#endif

} // namespace relumine::files
