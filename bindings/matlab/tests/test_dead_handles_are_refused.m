function test_dead_handles_are_refused()
% SPDX-License-Identifier: MIT
closed = 'roburoc4:closed';
% MATLAB itself refuses to read a property of what was deleted.
dead_id = closed;
if ~exist('OCTAVE_VERSION', 'builtin')
    dead_id = 'MATLAB:class:InvalidHandle';
end
mex = @roburoc4_mex;
sim = roburoc4.Simulator();
r = sim.connect();
id = r.id;
ids = {0, -1, 1, id + 1, id - 1, id + 64, 1e300, NaN, Inf, -Inf, 0.5, sim.id, uint64(1), true};
for k = 1:numel(ids)
    check_raises(closed, @() mex('status', ids{k}));
    check_raises(closed, @() mex('drive', ids{k}, 0.1, 0));
    mex('close', ids{k});
    mex('interrupted', ids{k});
end
check_raises(closed, @() mex('simState', id));
check(living_robots() == 1, 'a made-up id closed the robot');

delete(r);
for attempt = 1:2
    dead = {@() r.status, @() r.drive(0, 0), @() r.stop(), @() r.arm(), @() r.sleep(0.1), ...
        @() r.record(0.1), @() r.log([tempname() '.mat']), @() r.inputs('x'), @() r.pose, ...
        @() r.driveFor(0.1, 0, 1), @() r.pause(), @() r.close(), @() r.relocalize(0, 0, 0), @() r.rate(10)};
    for k = 1:numel(dead)
        check_raises(dead_id, dead{k});
    end
    mex('close', id);
    if attempt == 1
        again = sim.connect();           % takes the same place, with another id
        check(again.id ~= id, 'an id was given twice');
    end
end
evalc('disp(r)');
clear r

% The simulator first, the robot later.
delete(sim);
check_raises(dead_id, @() sim.state);
check_raises(dead_id, @() sim.step(1));
check_raises(closed, @() again.drive(0.1, 0));
check_raises(closed, @() again.sleep(0.1));
s = again.status;
check(~s.ready && ~s.armed && ~s.driving && ~s.stopping && s.localization_age_s == Inf, 'it is gone');
check(strcmp(s.disarm_text, 'its simulator was deleted'), 'disarm_text: %s', s.disarm_text);
check(all(isnan([again.pose, again.speeds])), 'a pose of a robot that is gone');
logged = again.log();
check(numel(logged.localization.x_m) > 0, 'what it had sent can be logged');
check(~isempty(strfind(evalc('disp(again)'), 'not ready')), 'disp');
delete(again);
clear again sim

% No more than 64, and no crash.
many = cell(1, 64);
for k = 1:64
    many{k} = roburoc4.Simulator();
end
check_raises('roburoc4:limit', @() roburoc4.Simulator());
check_raises('roburoc4:limit', @() many{1}.connect());
check_raises('roburoc4:limit', @() roburoc4.Robot('127.0.0.1:9', 'timeout', 0));
for k = 1:64
    delete(many{k});
end
end
