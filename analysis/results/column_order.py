"""The order of columns in schema 2 of encounters.csv and runs.csv, for programs that use positions.

The order is fixed, and nothing has to be added here: other columns follow after these, metric by metric.
"""

from __future__ import annotations

from collections.abc import Iterable

from analysis.tables.column import Column

ENCOUNTERS = """
schema_version run_id encounter_id config_id scenario_id seed ego_id ped_id ped_type crossing_id
crossing_type priority passage_id t_start_s t_end_s entered censored conflict_type first_user
ego_length_m ego_width_m ped_radius_m min_ttc_s t_min_ttc_s ttc_status min_ttc_1d_s pet_area_s
pet_status et_ego_s et_ped_s gap_time_s tadv_min_s t2_min_s min_dist_m t_min_dist_s clearance_min_m
close_pass_speed_mps dce_m ttce_s drac_max_mps2 drac_status mdrac_max_mps2 mdrac_prt_s mdrac_status
tet_1p5_s tit_1p5_s2 tet_3p0_s tit_3p0_s2 ego_speed_at_min_ttc_mps ped_speed_at_min_ttc_mps
conflicting_speed_mps time_to_accident_s max_speed_mps delta_s_mps delta_v_ped_mps ego_max_decel_mps2
ego_max_abs_jerk_mps3 ego_max_lat_accel_mps2 ego_stopped ped_wait_s ped_delay_s yielded evasive_t_s
evasive_status collision n_collisions t_collision_s contact_standing impact_speed_kmh impact_side
p_fatal_rosen2009 p_mais3_mm2025 severity x_conflict_m y_conflict_m controller_status contact_place
contact_moved_by contact_class contact_risk_seen_s preventable_r157 visible_before_conflict_s late_entry
k_mean_s n_interventions n_straight n_lane_change n_autonomous slack_share side_changes actuation
sensing hidden_before_conflict
"""

RUNS = """
schema_version run_id config_id scenario_id seed controller tool_version git_sha sumo_version
wall_start_utc wall_s wall_rtf step_s warmup_s duration_s valid invalid_reason actuation sensing
ego_count ego_dist_km ego_time_h ped_count n_encounters n_entered n_passages n_ttc_defined n_ttc_lt_1p0
n_ttc_lt_1p5 n_ttc_lt_3p0 n_pet_defined n_pet_lt_1p0 n_pet_lt_1p5 n_pet_lt_3p0 n_pet_lt_5p0
n_drac_gt_3p4 n_mdrac_gt_3p4 n_collisions n_collisions_preventable n_collisions_crossing
n_collisions_carriageway n_collisions_walking_area_or_kerb n_collisions_moved_by_ego
n_collisions_moved_by_pedestrian n_collisions_moved_by_both n_collisions_class_ego
n_collisions_class_rolled_off n_collisions_class_appeared n_collisions_class_touching_at_start
n_contacts_standing n_severity_severe n_severity_serious n_severity_slight n_severity_none min_ttc_s
p05_min_ttc_s min_pet_s tet_1p5_s tit_1p5_s2 min_dist_m n_clearance_defined clearance_min_m
clearance_p01_m clearance_p05_m n_close_passes max_decel_mps2 n_hard_brake p95_abs_jerk_mps3
n_late_entries yields yieldable yield_rate n_ped_delay_defined ped_delay_mean_s ped_delay_p95_s
ped_los_hcm2010 ego_mean_speed_mps ego_time_loss_s ego_delay_mean_s n_conflicts conflicts_per_veh_km
conflicts_per_1000_ped n_plans n_solver_fail n_shielded slack_share n_interventions
n_interventions_tight_bend n_interventions_way_lost n_interventions_off_lane n_interventions_held
n_interventions_position n_interventions_speed n_straight n_lane_change n_autonomous n_lane_changes
side_changes n_stopped_on_crossing n_stopped_on_crossing_foreseeable deadlock n_vehicle_overlaps
n_vehicle_overlaps_ego_closed k_mean_s compute_p50_ms compute_p95_ms compute_p99_ms n_teleports
sum_p_fatal_rosen2009 n_follower_conflicts n_follower_ttc_lt_1p5 n_follower_drac_gt_3p4
follower_min_ttc_s follower_max_drac_mps2 n_vehicle_conflicts_following n_vehicle_conflicts_beside
n_vehicle_conflicts_oncoming n_vehicle_conflicts_crossing min_vehicle_pet_s n_hidden_before_conflict
"""


def in_order(columns: Iterable[Column], order: str) -> tuple[Column, ...]:
    """Return the columns in the order of their names in a text; the others come last, in their own order."""
    place = {name: number for number, name in enumerate(order.split())}
    return tuple(sorted(columns, key=lambda column: place.get(column.name, len(place))))
