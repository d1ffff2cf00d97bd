#include "mesh/materials/light_profile.h"
#include "tests/fuzz/fuzz.h"

RELUMINE_FUZZ_TARGET(ies) {
    using namespace relumine;
    const auto read =
        fuzz::accepted([&] { return mesh::read_light_profile(fuzz::bytes(data, size)); });
    if (!read)
        return 0;
    const mesh::LightProfile& profile = read->profile;
    const double largest{profile.largest()};
    for (double v = -10.0; v <= 190.0; v += 7.3)
        for (double h = -400.0; h <= 400.0; h += 37.7) {
            const double candela = profile.at(v, h);
            fuzz::require(candela >= 0.0 && candela <= largest * (1.0 + 1e-9),
                          "an intensity is not negative and no more than the largest");
        }
    const double flux = profile.flux();
    fuzz::require(flux >= -1e-6 * largest && flux <= 12.6 * largest,
                  "the flux is no more than that of the largest intensity all around");
    fuzz::require(mesh::LightProfile(profile.table()) == profile, "a table is taken again");
    return 0;
}
