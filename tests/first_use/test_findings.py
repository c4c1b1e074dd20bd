"""Findings of first hours with the program, and the tests by which none can be met again.

The tests are named as ``package/module::test``, below `tests`. A finding without a test, or a test
that is renamed or gone, fails here.
"""

import ast

import pytest

from tests.places import ROOT

TESTS = ROOT / "tests"
_DESCRIPTION, _STATED = "chatter/description", "chatter/description/test_stated_cut"
_ENGAGEMENT, _MATERIALS = (
    f"{_DESCRIPTION}/test_stated_engagement",
    f"{_DESCRIPTION}/test_material_table",
)
_QUESTIONED, _PYTHON = f"{_DESCRIPTION}/test_questioned", f"{_DESCRIPTION}/test_python_calls"
_WORN, _SETTLED = "chatter/simulation/test_worn_flank", "chatter/simulation/test_settled_values"
_FINISH, _SIMULATE = "chatter/simulation/test_finish", "chatter/cli/test_simulate_command"
_LIFE, _STUDIES = "chatter/studies/test_tool_life", "chatter/studies/whatif/test_studies"
_NEGLECTED, _POCKETS = "chatter/stability/test_neglected_effects", "chatter/stability/test_pockets"
_BIFURCATION, _PROGRESS = "chatter/studies/test_bifurcation", "chatter/cli/test_progress"
_WHATIF_PICTURES = "chatter/studies/whatif/test_pictures"
_SHARES, _JSON = (
    "chatter/studies/uncertainty/test_shares_of_variance",
    "chatter/cli/test_json_where_asked",
)
_INCLINED, _LIVE = "chatter/compile/test_inclined_axis", "chatter/app/test_live_case"
_CUTTING_TESTS = "chatter/explain/cutting_tests/test_cutting_tests"
_HERE, _JOBS = "first_use", "test_ordinary_jobs"

FINDINGS = {
    # wear
    "a worn flank takes force away": (
        f"{_WORN}::test_mean_forces_grow_by_pressure_and_friction_of_the_land",
        f"{_WORN}::test_the_power_grows_by_the_friction_alone",
    ),
    "a worn flank lifts a limit of 1.8 mm above 30 mm without a word": (
        f"{_WORN}::test_limits_stay_and_that_is_said",
        "cutting/process_damping/test_ploughing::test_damping_grows_with_the_square_of_the_land",
    ),
    "the law of wear has no source": (f"{_WORN}::test_the_assumed_pressure_is_said",),
    "tool life is no limit": (
        f"{_LIFE}::test_twice_the_speed_lasts_a_sixteenth",
        f"{_LIFE}::test_the_optimum_keeps_to_speeds_at_which_the_edge_lasts",
        f"{_WORN}::test_a_land_beyond_the_end_of_life_is_said",
    ),
    "a value that nothing uses is taken without a word": (
        f"{_HERE}/test_without_effect::test_what_nothing_uses_is_named_and_changes_nothing",
        f"{_HERE}/test_without_effect::test_commands_say_it",
        f"{_STUDIES}::test_a_value_that_nothing_uses_is_said_to_be_without_effect",
    ),
    # tools
    "a pocket of 69.5 mm for a cutter of 16 mm": (
        f"{_STATED}::test_no_search_is_deeper_than_the_tool_can_cut",
        f"{_STATED}::test_a_cut_deeper_than_the_flutes_is_refused",
        f"{_QUESTIONED}::test_a_deep_limit_asks_for_the_length_of_the_flutes",
    ),
    "no key for flutes, stick-out, feed rate, cutting speed": (
        f"{_STATED}::test_cutting_speed_is_pi_diameter_speed",
        f"{_STATED}::test_feed_rate_is_feed_teeth_speed",
        f"{_SETTLED}::test_cutting_speed_and_feed_rate_are_shown",
        f"{_QUESTIONED}::test_a_tool_is_no_stiffer_than_its_stick_out",
    ),
    # engagement
    "a centred face mill cannot be stated": (
        f"{_ENGAGEMENT}::test_mean_forces_of_face_milling",
        f"{_ENGAGEMENT}::test_methods_agree_on_face_milling",
        f"{_ENGAGEMENT}::test_an_offset_to_either_side_mirrors_the_engagement",
    ),
    "a ball at 0.5 mm depth and 0.4 mm stepover is refused with riddles": (
        f"{_ENGAGEMENT}::test_a_ball_beside_its_pass_before",
        f"{_ENGAGEMENT}::test_a_radial_depth_that_a_ball_does_not_reach_names_the_stepover",
    ),
    "no inclined axis, no effective diameter": (
        f"{_INCLINED}::test_effective_diameter_of_a_ball",
        f"{_INCLINED}::test_check_shows_it",
        f"{_STATED}::test_the_effective_diameter_of_a_ball_is_shown",
    ),
    "an empty table of pockets, 100 % below the limit, for a finishing ball": (
        f"{_HERE}/test_words::"
        "test_where_no_linear_limit_bounds_the_true_one_it_is_said_with_what_computes_it",
    ),
    # materials
    "few materials, without source or range": (
        f"{_HERE}/test_materials::test_there_are_rows_of_every_family_with_source_and_range",
        f"{_MATERIALS}::test_the_range_of_a_row_is_checked_against_the_thickest_chip",
        f"{_MATERIALS}::test_rows_of_an_own_table",
        f"{_MATERIALS}::test_a_grade_is_answered_by_the_rows_of_its_conditions",
        f"{_MATERIALS}::test_a_condition_chooses_among_the_rows_of_a_grade",
    ),
    "coefficients that are used are not printed": (
        "chatter/cli/test_materials_command::test_commands_print_the_coefficients",
    ),
    # slips
    "14000 is taken as rad/s": (
        f"{_STATED}::test_a_bare_spindle_speed_is_refused_with_the_units_it_could_have",
        f"{_STATED}::test_other_bare_speeds_of_a_cut_are_refused_as_well",
    ),
    "a stiffness of 15 N/mm, a spectral radius of 7e11": (
        f"{_QUESTIONED}::test_a_value_in_the_wrong_unit_is_asked_about",
        f"{_QUESTIONED}::test_growth_is_told_in_words",
        f"{_HERE}/test_words::test_a_growth_that_no_number_describes_has_no_frequency",
        f"{_HERE}/test_words::test_slips_of_a_unit_are_asked_about",
        f"{_HERE}/test_words::test_feeds_are_written_as_people_write_them",
    ),
    # settled values
    "the peak is the jolt of the start": (
        f"{_SETTLED}::test_peaks_are_those_of_the_last_half",
        f"{_SETTLED}::test_the_start_is_given_apart_on_the_terminal",
    ),
    "forces of chatter are given as those of a settled cut": (
        f"{_HERE}/test_words::test_the_reason_of_a_verdict_has_no_change_of_zero",
        f"{_HERE}/test_words::test_a_study_of_forces_says_where_the_cut_chatters",
    ),
    "a face mill leaves Ra 0 um, and a wall where it leaves a floor": (
        f"{_FINISH}::test_a_sharp_corner_has_a_location_of_the_floor_and_no_roughness",
        f"{_FINISH}::test_a_tool_that_overhangs_on_both_sides_leaves_no_wall",
        f"{_JOBS}::test_a_job_prints_what_the_page_says",
    ),
    "a cut that leaves the range stops without verdict and files": (
        f"{_SIMULATE}::test_a_run_that_leaves_the_range_writes_what_there_is",
    ),
    # one truth
    "check and simulate differ without a word": (
        f"{_NEGLECTED}::test_check_says_that_a_cut_just_below_the_limit_is_not_certain",
        f"{_NEGLECTED}::test_simulate_names_the_other_verdict_and_the_number_that_decides",
        f"{_NEGLECTED}::test_lobes_says_it_of_the_operating_point",
        f"{_HERE}/test_words::test_a_sheet_reports_its_speeds_and_says_what_is_not_certain",
        f"{_HERE}/test_words::test_a_diagram_over_another_value_says_what_check_says_of_edge_forces",
    ),
    "a pocket in a valley": (
        f"{_POCKETS}::test_no_pocket_is_shallower_than_what_any_speed_allows",
    ),
    "stable at any speed is the least of some samples": (
        f"{_HERE}/test_lowest_limit::test_it_does_not_depend_on_the_count_of_speeds",
        f"{_HERE}/test_lowest_limit::test_it_is_a_bound_by_every_method",
        f"{_HERE}/test_lowest_limit::"
        "test_the_lowest_limit_of_pitch_angles_is_that_of_speeds_between_too",
    ),
    "bifurcation prints 0.0004: chatter; its picture ends before its points": (
        f"{_HERE}/test_words::test_bifurcation_says_from_where_to_where_with_units",
        f"{_HERE}/test_pictures::test_a_bifurcation_ends_where_its_points_end",
        f"{_BIFURCATION}::test_cuts_that_leave_the_range_of_the_model_are_told_and_marked",
    ),
    # pictures
    "the depth axis goes far beyond the lobes": (
        f"{_HERE}/test_pictures::test_the_depth_axis_ends_a_little_above_the_lobes",
    ),
    "a staircase of colour beside a smooth curve": (
        f"{_HERE}/test_pictures::test_colour_ends_at_the_curve_between_values_too",
    ),
    "white that is not explained": (
        f"{_HERE}/test_pictures::test_what_is_not_searched_is_in_the_legend",
    ),
    "one mark for very stable and for failed; a curve of the legend is not drawn": (
        f"{_WHATIF_PICTURES}::test_what_has_no_limit_is_marked_above_every_curve",
        f"{_WHATIF_PICTURES}::test_a_failure_is_marked_otherwise",
    ),
    "what margins leave is filled up to the limit": (
        f"{_HERE}/test_optimum_picture::test_what_is_kept_with_a_confidence_is_not_called_a_margin",
    ),
    "verdicts without a limit curve, on an axis of one tick": (
        f"{_HERE}/test_pictures::test_verdicts_stand_with_the_limit_on_an_axis_that_can_be_read",
        "chatter/app/test_residual_view::test_a_map_and_points_have_cells_and_classes",
    ),
    "a stable cut lies in what is hatched as not certain": (
        f"{_HERE}/test_pictures::test_hatching_says_what_check_says",
        f"{_HERE}/test_pictures::test_nothing_is_hatched_where_no_limit_is_found",
    ),
    "a legend covers the curves of FRFs": (
        f"{_HERE}/test_pictures::test_the_legend_of_frfs_covers_no_curve",
    ),
    "browser: a step at the peak of a lobe; no limit after the cut is narrowed": (
        f"{_LIVE}::test_coarse_diagram_follows_the_boundary_that_the_fine_one_finds",
        "chatter/app/test_workbench::test_stable_without_limit_up_to_the_top_of_the_diagram",
    ),
    # syntax
    "three syntaxes of ranges": (
        f"{_STATED}::test_one_syntax_of_ranges",
        f"{_HERE}/test_ranges::test_a_range_is_stated_as_text_in_a_file",
        f"{_HERE}/test_ranges::test_the_schema_takes_a_range_either_way",
    ),
    "none works in one command": (f"{_STATED}::test_none_takes_a_key_away_everywhere",),
    "a slot needs a second change": (f"{_STATED}::test_a_slot_needs_no_second_change",),
    "check returns 0 for chatter": (f"{_NEGLECTED}::test_exit_code_for_scripts",),
    "JSON that nobody asked for": (f"{_JSON}::test_words_by_default_and_json_alone_where_asked",),
    # numbers and words
    "shares of variance add up to 107 %": (f"{_SHARES}::test_lines_add_up_to_a_hundred",),
    "a change of +0.0 % a turn": (
        f"{_HERE}/test_words::test_the_reason_of_a_verdict_has_no_change_of_zero",
    ),
    "3.74e+3 W": (f"{_HERE}/test_words::test_large_numbers_have_no_exponent",),
    "by -1e+02 %; +- 1.4e+02": (
        f"{_HERE}/test_words::test_two_digits_have_no_exponent",
        f"{_HERE}/test_words::test_no_percentage_or_deviation_is_printed_with_an_exponent",
    ),
    "rms error [SI]": (
        f"{_HERE}/test_words::test_errors_of_compare_have_the_unit_of_their_channel",
    ),
    "offset 1.1736e-05 m, angle 0.68159 rad": (
        f"{_HERE}/test_words::test_parameters_of_effects_are_in_units_of_people",
    ),
    "an error table without headings": (
        f"{_HERE}/test_words::test_tables_of_explain_have_headings",
    ),
    "8 of 40 verdicts wrong and nothing missing; a coefficient moved without a word": (
        f"{_CUTTING_TESTS}::test_what_was_refitted_is_told_by_how_much",
    ),
    "the highest peak is another one, as a change of its frequency": (
        f"{_HERE}/test_words::test_another_peak_is_no_change_of_a_frequency",
    ),
    "measurement.toml has no example": (
        f"{_HERE}/test_words::test_a_folder_without_a_measurement_says_what_it_lacks",
        f"{_HERE}/test_words::test_the_documents_have_a_measurement_file",
    ),
    # waits
    "nothing for 100 s": (
        f"{_HERE}/test_waits::test_multi_frequency_reports_as_it_goes",
        f"{_PROGRESS}::test_every_command_that_computes_shows_its_progress",
        f"{_PROGRESS}::test_lines_where_there_is_no_terminal",
    ),
    "minutes begin without an estimate": (f"{_PROGRESS}::test_minutes_are_announced_once",),
    "all 30 done, and it still computes": (
        f"{_HERE}/test_words::"
        "test_progress_of_simulated_cuts_never_says_that_all_is_done_before_it_is",
    ),
    # Python
    "rad/s and other SI without a word": (f"{_PYTHON}::test_limits_in_units_that_people_read",),
    "reprs fill the screen": (
        f"{_PYTHON}::test_reprs_are_short_and_name_the_case",
        f"{_HERE}/test_second_look::test_cuts_of_an_optimum_and_of_a_sheet_have_short_reprs",
    ),
    "dir(chatter) shows Any and TYPE_CHECKING": (f"{_PYTHON}::test_what_is_listed_is_public",),
    "lobes of a path raises AttributeError": (
        f"{_PYTHON}::test_a_path_is_accepted_where_a_case_is",
    ),
    "chatter.compare and chatter.explain are not there": (
        f"{_HERE}/test_words::test_calls_of_the_loop_are_there_in_python",
    ),
}  # fmt: skip


def names_in(module):
    """Names of the tests of a module."""
    tree = ast.parse((TESTS / f"{module}.py").read_text(encoding="utf-8"))
    return {
        node.name
        for node in ast.walk(tree)
        if isinstance(node, ast.FunctionDef) and node.name.startswith("test_")
    }


@pytest.mark.parametrize("finding", FINDINGS)
def test_a_finding_has_tests(finding):
    assert FINDINGS[finding]
    for one in FINDINGS[finding]:
        module, _, name = one.partition("::")
        assert name in names_in(module), one
