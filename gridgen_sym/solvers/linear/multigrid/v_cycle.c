/* One V-cycle from a zero start: smooth, correct from the coarser levels, smooth backwards. */

enum { COARSEST_SWEEPS = 4 };

/* solution = V-cycle(right); small levels are worked on by one thread. */
static void v_cycle(const Level *levels, int64_t count, Team team) {
  if (team.size > 1 && levels->threads == 1) {
    if (team.rank == 0) v_cycle(levels, count, (Team){0, 1, 0});
    wait_for(team);
    return;
  }
  smooth(levels, team, 1);
  if (count > 1) {
    compute_residual(levels, team);
    restrict_residual(levels, levels + 1, team);
    v_cycle(levels + 1, count - 1, team);
    correct(levels + 1, levels, team);
  }
  for (int sweep = 1; count == 1 && sweep < COARSEST_SWEEPS; ++sweep)
    smooth_backwards(levels, team), smooth(levels, team, 0);
  smooth_backwards(levels, team);
}
