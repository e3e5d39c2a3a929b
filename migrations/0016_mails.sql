-- E-mail beside webhooks: an address is told of the same events, through the same outbox.
ALTER TABLE webhooks ADD COLUMN channel TEXT NOT NULL DEFAULT 'webhook'
    CHECK (channel IN ('webhook', 'mail'));
-- What an address of e-mail is to be told of once the link that was sent there has been followed. Until
-- then its `events` are none, so that whatever tells of events passes it by; afterwards this is NULL.
ALTER TABLE webhooks ADD COLUMN wanted TEXT;
