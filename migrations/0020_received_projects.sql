-- Whether a project was given to the person whose it is: then it takes no job that names no project, for who
-- sees it was chosen by somebody else.
ALTER TABLE projects ADD COLUMN is_received INTEGER NOT NULL DEFAULT 0;

-- Of before: a person's own is the project of the very moment in which the account was made, and those whose
-- line in the audit log says that this person made them; every other one came from somebody else.
UPDATE projects SET is_received = 1
WHERE person IS NOT NULL
  AND created_at <> (SELECT p.created_at FROM people p WHERE p.id = projects.person)
  AND NOT EXISTS (SELECT 1 FROM audit a WHERE a.object = projects.id AND a.action = 'project.made'
                    AND a.person = projects.person);
