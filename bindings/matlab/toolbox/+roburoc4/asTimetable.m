function table = asTimetable(columns)
%ASTIMETABLE Make a timetable of one service's columns.
%   TABLE = roburoc4.asTimetable(DATA.localization) takes the columns of a service, as record, log and
%   load give them, and returns a timetable whose row times are utc_s as datetimes. Octave has no
%   timetables: there it returns the columns unchanged.
%
%   Example:
%      data = r.record(2);
%      poses = roburoc4.asTimetable(data.localization);
%
%   See also roburoc4.Robot, timetable, synchronize.

% SPDX-License-Identifier: MIT
if ~isstruct(columns) || ~isscalar(columns) || ~isfield(columns, 'utc_s')
    error('roburoc4:badArgument', ['this is %s; give the columns of a service, such as ' ...
        'data.localization'], roburoc4.internal.kind(columns));
end
table = columns;
if ~exist('OCTAVE_VERSION', 'builtin')
    moments = datetime(columns.utc_s, 'ConvertFrom', 'posixtime', 'TimeZone', 'UTC');
    table = table2timetable(struct2table(columns), 'RowTimes', moments);
end
end
