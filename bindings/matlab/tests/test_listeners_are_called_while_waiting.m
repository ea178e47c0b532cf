function test_listeners_are_called_while_waiting()
% What listens gets each status and each event once, in whatever method waits, and never in between;
% an error in it stops the robot.
% SPDX-License-Identifier: MIT
sim = roburoc4.Simulator();
r = sim.connect();
heard = containers.Map({'poses', 'events'}, {[], {}});
r.listen('localization', @(s) keep(heard, 'poses', s.time_s));
r.listen('event', @(s) keep(heard, 'events', {s.name}));
sim.step(0.3);
check(isempty(heard('poses')), 'called although nothing waits');
r.sleep(0.2);
check(numel(heard('poses')) >= 9 && all(diff(heard('poses')) > 0), 'not each status once: %d', ...
    numel(heard('poses')));
r.arm();
r.move(0.2);
loop = r.rate(20);
for k = 1:4
    r.drive(0.1, 0);
    loop.wait();
end
sim.set('pad_a', true);
loop.wait();
loop.wait();
check(heard_once(heard, 'armed') && heard_once(heard, 'override') && heard_once(heard, 'disarmed'), ...
    'events: %s', strjoin(heard('events'), ' '));
sim.set('pad_a', false);
before = numel(heard('poses'));
r.record(0.5, 'battery');
r.receive('battery', 2);
check(numel(heard('poses')) >= before + 10, 'record and receive do not wait');

% [] ends it.
r.listen('localization', []);
before = numel(heard('poses'));
r.sleep(0.2);
check(numel(heard('poses')) == before, 'called after its end');

% A stop within it ends a move; an error stops the robot, and is the error of the method.
r.arm();
r.listen('telemeter', @(s) r.stop());
check_raises('roburoc4:moveEnded', @() r.move(3));
r.listen('telemeter', @(s) error('test:mine', 'this is an error of mine'));
check_raises('test:mine', @() r.rest());
r.listen('telemeter', []);
r.arm();
r.listen('telemeter', @(s) error('test:mine', 'this is an error of mine'));
check_raises('test:mine', @() r.driveFor(0.3, 0, 3));
check(~r.status.armed, 'an error in it has not stopped the robot');

% It must not wait, and what cannot be called is refused.
r.listen('telemeter', @(s) r.sleep(0.1));
check_raises('roburoc4:badArgument', @() r.sleep(0.3));
r.listen('telemeter', []);
r.sleep(0.3);
check_raises('roburoc4:badArgument', @() r.listen('camera', @disp));
check_raises('roburoc4:badArgument', @() r.listen('battery', 5));
check_raises('roburoc4:badArgument', @() r.listen('battery'));
delete(r);
check_raises('roburoc4:closed', @() r.listen('battery', @disp));
delete(sim);

% In real time, too; clearing the object ends it.
live = roburoc4.Simulator('port', 0);
r = live.connect();
heard = containers.Map({'poses', 'events'}, {[], {}});
r.listen('differential', @(s) keep(heard, 'poses', s.time_s));
begun_s = r.time_s;
while numel(heard('poses')) < 20
    r.sleep(0.05);
    check(r.time_s < begun_s + 60, 'only %d statuses in a minute', numel(heard('poses')));
end
clear r
check(living_robots() == 0, 'a listener keeps the robot');
delete(live);
end

function keep(heard, name, value)
heard(name) = [heard(name), value];
end

function once = heard_once(heard, name)
once = sum(strcmp(heard('events'), name)) == 1;
end
