# What the runtime takes of the libraries' sources, from the project's folder, and how. web/wasm/ takes the same.
# Without locales, which were a fourth of the library, for commas in large numbers.
set(runtime_definitions FMT_HEADER_ONLY FMT_STATIC_THOUSANDS_SEPARATOR=',' XXH_INLINE_ALL)
set(runtime_sources
    cubemap/cube_map.cpp cubemap/face.cpp cubemap/image/image_layout.cpp cubemap/image/projection.cpp cubemap/resample/resample_lat_long.cpp cubemap/rotation.cpp cubemap/turned_texels.cpp cubemap/turned_tile.cpp cubemap/turned_tile_kernels.cpp
    files/compression.cpp files/free_memory.cpp files/hash.cpp files/json.cpp files/large_vector.cpp files/output_file.cpp files/packed_parts.cpp files/posix_file.cpp files/printable.cpp
    mesh/edge_uses.cpp mesh/materials/brdf_table.cpp mesh/subject.cpp mesh/triangle_mesh.cpp
    prt/bounces/bounce_matrix.cpp prt/bounces/point_rows.cpp prt/clusters/lattice.cpp prt/glossy/brdf.cpp prt/glossy/ggx_energy.cpp prt/glossy/lobe_kernel.cpp prt/glossy/sheen_lobe.cpp prt/glossy/thin_film.cpp
    prt/receivers/camera.cpp prt/receivers/mesh_point.cpp prt/receivers/receiver_layout.cpp prt/receivers/receiver_order.cpp prt/receivers/receivers.cpp
    prt/scene/absent_groups.cpp prt/scene/bounce_sections.cpp prt/scene/brdf_sections.cpp prt/scene/cluster_sections.cpp prt/scene/count_sections.cpp prt/scene/mesh_sections.cpp prt/scene/receiver_sections.cpp prt/scene/packed_mesh.cpp prt/scene/relighting_file.cpp
    prt/scene/packed_sections.cpp prt/scene/section_file.cpp prt/scene/section_format.cpp prt/scene/section_reader.cpp prt/scene/small_numbers.cpp prt/scene/settings_sections.cpp
    prt/transfer/glossy_transfer.cpp prt/transfer/quadtree.cpp prt/transfer/transfer.cpp prt/transfer/visible_counts.cpp
    prt/visibility/bias.cpp prt/visibility/blockers.cpp
    relight/adjoint/adjoint.cpp relight/adjoint/adjoint_kernel.cpp relight/adjoint/contribution.cpp
    relight/binned_environment.cpp relight/radiance.cpp relight/bounces/bounce_adjoint.cpp relight/bounces/bounce_kernel.cpp relight/bounces/bounce_light.cpp relight/bounces/bounce_product.cpp relight/bounces/coarse_bounces.cpp relight/bounces/point_gather.cpp
    relight/harmonics/cluster_harmonics.cpp relight/harmonics/harmonic_kernels.cpp relight/harmonics/harmonic_light.cpp relight/harmonics/harmonics.cpp
    relight/kernels/band_sums.cpp relight/kernels/block_kernels.cpp relight/kernels/cluster_lights.cpp relight/kernels/glossy_kernels.cpp relight/kernels/kernel_lights.cpp
    relight/kernels/texel_kernel.cpp relight/kernels/tile_words.cpp relight/kernels/update_kernel.cpp relight/light_pyramid.cpp relight/receiver_light.cpp relight/relighter.cpp relight/visible_parts.cpp
    relight/sharp/cluster_sums.cpp relight/sharp/light_packets.cpp relight/sharp/sharp_lights.cpp relight/sharp/traced_kernel.cpp relight/sharp/traced_light.cpp)
