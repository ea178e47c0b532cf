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
sim.step(0.12);
loop.wait();
check(loop.overruns == 2, '%d overruns after a long turn', loop.overruns);
check(abs(loop.time_s - 2.15) < 1e-3, 'at %g s', loop.time_s);

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
