"""The elements of SDF that contain numbers and nothing else, wherever they are."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping

_TAGS = {
    1: """
        acceleration accuracy angle angular anti_aliasing aspect_ratio attach_steps bias_mean bias_stddev bone_attachment bounce c1 c2
        c3 category_bitmask cfm coefficient collide_bitmask collide_without_contact_bitmask cols constant contact_max_correcting_vel
        contact_surface_layer cutoff_angle cx cy damping delay_start density detach_steps direction dissipation duration
        dynamic_bias_correlation_time dynamic_bias_stddev dynamic_friction effort elastic_modulus elevation end env_texture_size erp f
        fade_dist falloff far far_clip flesh_mass_fraction fov frequency friction friction2 fudge_factor fx fy gain gearbox_ratio
        granularity heading_deg height horizontal_fov humidity inner_angle intensity island_threads iterations iters ixx ixy ixz iyy
        iyz izz k1 k2 k3 kd kp laser_retro latitude_deg layer length lifetime linear longitude_deg lower mass max max_angle
        max_contacts max_convex_hulls max_dist max_force max_frequency max_step_size max_transient_velocity max_vel max_velocity mean
        mean_size min min_angle min_contact_count min_depth min_dist min_frequency min_height min_step_size min_velocity model_count
        mu mu2 multiplier near near_clip offset outer_angle override_impact_capture_velocity override_stiction_transition_velocity p1
        p2 p_cx p_cy p_fx p_fy particle_scatter_ratio patch_radius pitch plastic_coef_restitution plastic_impact_velocity
        poissons_ratio position power pp pq pr precision precon_iters pressure qq qr quadratic radius range rate real_time
        real_time_factor real_time_update_rate reference reference_altitude render_order resolution restitution_coefficient
        rolling_friction rows rr s samples sampling scale scale_rate screw_thread_pitch sensitivity shininess sim_time size slip slip1
        slip2 soft_cfm soft_erp sor speed split_impulse_penetration_threshold spring_reference spring_stiffness start static_friction
        stddev stiffness sunrise sunset surface_axis_equatorial surface_axis_polar surface_radius temperature temperature_gradient
        thread_pitch threshold time transparency tx ty update_rate upper velocity viscous_friction visibility_flags visibility_mask
        voltage voxel_resolution wall_time width xp xq xr xx xy xz yp yq yr yy yz zp zq zr zz
    """,
    2: """
        point
    """,
    3: """
        ambient angular_acceleration angular_velocity background color color_end color_start custom_rpy emissive fdir1 force
        grav_dir_x linear_acceleration linear_velocity magnetic_field particle_size pos radii specular step torque xyz
    """,
    6: """
        pose wrench
    """,
}
LEAST_NUMBERS: Mapping[str, int] = MappingProxyType({tag: least for least, tags in _TAGS.items() for tag in tags.split()})
"""How many numbers each contains at least. Source: the schema of SDF 1.12; tags that have other contents elsewhere are left out."""
LEAST_NUMBERS_IN: Mapping[tuple[str, str], int] = MappingProxyType({("world", "gravity"): 3, ("distortion", "center"): 2})
"""The same for those tags, with the element around them."""
