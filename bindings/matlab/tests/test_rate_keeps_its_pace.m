function test_rate_keeps_its_pace()
% SPDX-License-Identifier: MIT
sim = roburoc4.Simulator();
r = sim.connect();
loop = r.rate(20);
ticks = 0;
while loop.time_s < 1.99
    loop.wait();
    ticks = ticks + 1;
end
check(ticks == 40 && loop.overruns == 0, '%d ticks, %d overruns', ticks, loop.overruns);
check(abs(loop.last_period_s - 0.05) < 1e-3, 'the last period: %g s', loop.last_period_s);
s = loop.statistics();
check(s.periods == 40 && abs(s.mean_s - 0.05) < 1e-6 && s.std_s < 1e-3, 'mean %g s', s.mean_s);
check(s.overruns == 0 && abs(s.min_s - s.max_s) < 1e-3, 'from %g to %g s', s.min_s, s.max_s);
sim.step(0.12);
loop.wait();
check(loop.overruns == 2, '%d overruns after a long turn', loop.overruns);
check(abs(loop.time_s - 2.15) < 1e-3, 'at %g s', loop.time_s);
s = loop.statistics();
check(s.overruns == 2 && abs(s.max_s - 0.15) < 1e-3, 'the longest period: %g s', s.max_s);
loop.reset();
s = loop.statistics();
check(loop.time_s == 0 && loop.overruns == 0 && isnan(loop.last_period_s), 'after a reset');
check(s.periods == 0 && isnan(s.mean_s) && isnan(s.std_s) && isnan(s.max_s), 'nothing yet');
loop.wait();
check(abs(loop.time_s - 0.05) < 1e-3, 'the first tick after a reset: %g s', loop.time_s);

% In real time it does not drift, whatever the load.
host = roburoc4.Simulator('port', 0);
real = host.connect();
loop = real.rate(50);
for k = 1:20
    loop.wait();
end
check(loop.time_s >= 0.399, '20 ticks in %g s', loop.time_s);
delete(real);
delete(host);

% A loop that is left over does not keep the robot driving, nor the object alive.
loop = r.rate(20);
r.arm();
r.drive(0.3, 0);
clear r
check(sim.state.target_linear_m_s == 0 && living_robots() == 0, 'the loop kept the robot');
check_raises('roburoc4:closed', @() loop.wait());
delete(sim);
end
