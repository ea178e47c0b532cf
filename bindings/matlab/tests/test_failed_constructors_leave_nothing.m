function test_failed_constructors_leave_nothing()
% SPDX-License-Identifier: MIT
begun = tic();
check_raises('roburoc4:timeout', @() roburoc4.Robot('127.0.0.1:9', 'timeout', 0.2));
check(toc(begun) >= 0.2, 'gave up too early');
check_raises('roburoc4:network', @() roburoc4.Robot('no.such.host.invalid'));
check_raises('roburoc4:network', @() roburoc4.Simulator('port', 0, 'host', '203.0.113.1'));

% Another port is named as remedy where it is one.
first = roburoc4.Simulator('port', 0);
port = str2double(regexprep(first.address, '.*:', ''));
check(is_told('give another port', port, '127.0.0.1'), 'no remedy for a port in use');
check(~is_told('give another port', 0, '203.0.113.1'), 'another port does not help');
delete(first);

sim = roburoc4.Simulator();
sim.set('power', false);
check_raises('roburoc4:timeout', @() sim.connect('timeout', 1));
check(living_robots() == 0, 'a robot was left');
try
    sim.connect('timeout', 1);
catch problem
    check(~isempty(strfind(problem.message, 'check that the robot is on')), '%s', problem.message);
end
delete(sim);
end

function yes = is_told(remedy, port, host)
yes = false;
try
    roburoc4.Simulator('port', port, 'host', host);
catch problem
    yes = ~isempty(strfind(problem.message, remedy));
end
end
